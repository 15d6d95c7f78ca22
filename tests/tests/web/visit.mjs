// A visit to the page in a browser without a window, by its debugging pipe: real files, real mouse
// events. On stdin JSON: { browser, page, flags, steps }; a step is { files } | { settings } | {
// box } | { keys } | { tree } | { until } | { click } | { screenshot } and may ask for { text } of
// the page's result. Prints for each step what the page shows then.
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import { pathToFileURL } from "node:url";
import { middle, text } from "./text.mjs";

const { browser, page, flags, steps } = JSON.parse(readFileSync(0, "utf8"));
const profile = mkdtempSync(join(tmpdir(), "visit-"));
const fixed = ["--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking", "--disable-component-update",
  "--disable-sync", "--hide-scrollbars", "--window-size=1280,1300", "--remote-debugging-pipe", `--user-data-dir=${profile}`];
const child = spawn(browser, [...fixed, ...flags, "about:blank"], { stdio: ["ignore", "ignore", "ignore", "pipe", "pipe"] });
const [to, from] = [child.stdio[3], child.stdio[4]];
const pending = new Map(), logged = [];
let received = Buffer.alloc(0), number = 0;
from.on("data", bytes => {
  received = Buffer.concat([received, bytes]);
  for (let end; (end = received.indexOf(0)) >= 0; received = received.subarray(end + 1)) {
    const { id, result, error, method, params } = JSON.parse(received.subarray(0, end));
    if (id !== undefined) pending.get(id)?.(error ? { failed: error.message } : result);
    if (method === "Network.requestWillBeSent") logged.push(params.request.url.slice(0, 80));
    if (method === "Runtime.exceptionThrown") logged.push(`exception: ${params.exceptionDetails.exception?.description}`);
  }
});

let sessionId;
const call = (method, params = {}) => new Promise(done => {
  pending.set(++number, done);
  to.write(`${JSON.stringify({ id: number, method, params, sessionId })}\0`);
}).then(result => {
  if (result.failed) throw new Error(`${method}: ${result.failed}`);
  return result;
});
async function evaluate(expression) {
  const { result, exceptionDetails } = await call("Runtime.evaluate", { expression, awaitPromise: true, returnByValue: true });
  if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
  return result.value;
}
const done = () => evaluate("Number(document.body?.dataset.done ?? 0)");
async function after(count) {
  for (const start = Date.now(); await done() <= count; await new Promise(wait => setTimeout(wait, 5))) {
    if (Date.now() - start > 30000) throw new Error(`the page did nothing: ${logged}`);
  }
}
const shown = `(() => {
  const of = id => { const at = document.getElementById(id); return at?.checkVisibility() ? at.innerText : ""; };
  return { error: of("error"), summary: of("summary"), names: of("names"), health: of("health"), top: of("top-note"),
    objects: [...document.querySelectorAll("#objects li")].map(item => item.firstChild.data), wide: document.documentElement.scrollWidth > innerWidth };
})()`;

async function drawn([x0, y0, x1, y1]) {
  await evaluate(`document.getElementById("left").scrollIntoView()`);
  const area = await evaluate(`(() => { const { left, top, width, height } = document.getElementById("left").getBoundingClientRect();
    const image = linestereo.size(); return [left, top, width / image[0], height / image[1]]; })()`);
  const mouse = (type, x, y, buttons) =>
    call("Input.dispatchMouseEvent", { type, x: area[0] + x * area[2], y: area[1] + y * area[3], button: "left", buttons, clickCount: 1 });
  await mouse("mousePressed", x0, y0, 1);
  await mouse("mouseMoved", (x0 + x1) / 2, (y0 + y1) / 2, 1);
  await mouse("mouseMoved", x1, y1, 1);
  await mouse("mouseReleased", x1, y1, 0);
}

async function take(step) {
  const before = await done();
  if (step.settings) {
    await evaluate(`Object.entries(${JSON.stringify(step.settings)}).forEach(([id, value]) => { document.getElementById(id)[typeof value === "boolean" ? "checked" : "value"] = value; });
      document.getElementById("settings").dispatchEvent(new Event("change"))`);
    if (step.changes) await after(before);
  }
  if (step.files) {
    const { root } = await call("DOM.getDocument");
    const { nodeId } = await call("DOM.querySelector", { nodeId: root.nodeId, selector: "#files" });
    await call("DOM.setFileInputFiles", { nodeId, files: step.files });
    await after(before);
  }
  if (step.box) await drawn(step.box);
  if (step.keys) {
    await evaluate(`document.getElementById("left").focus()`);
    for (const [key, modifiers] of step.keys) {
      for (const type of ["keyDown", "keyUp"]) await call("Input.dispatchKeyEvent", { type, key, code: key, modifiers });
    }
  }
  if (step.until) {
    for (const start = Date.now(); !(await evaluate(step.until)); await new Promise(wait => setTimeout(wait, 20))) {
      if (Date.now() - start > 30000) throw new Error(`never: ${step.until}`);
    }
  }
  if (step.click) {
    await evaluate(`document.getElementById(${JSON.stringify(step.click)}).click()`);
    await after(before + (step.frames ?? 0));
  }
  if (step.screenshot) {
    await evaluate("scrollTo(0, 0)");
    writeFileSync(step.screenshot, Buffer.from((await call("Page.captureScreenshot", {})).data, "base64"));
  }
  const found = await evaluate(shown);
  if (step.keys) found.box = await evaluate(`document.getElementById("box").innerText`);
  if (step.tree) {
    const { nodes } = await call("Accessibility.getFullAXTree");
    found.tree = nodes.filter(({ ignored }) => !ignored).map(({ role, name }) => `${role?.value}: ${name?.value}`);
  }
  if (step.text) {
    found.text = await evaluate(`(${text})(linestereo.csv(), linestereo.result(), linestereo.box((${middle})(...linestereo.size())))`);
  }
  return found;
}

// Processes of the browser that outlive it for a moment still write to its profile.
async function removeProfile() {
  for (let tries = 100; ; tries -= 1) {
    try {
      return rmSync(profile, { recursive: true, force: true });
    } catch (error) {
      if (tries === 0) throw error;
      await new Promise(waited => setTimeout(waited, 100));
    }
  }
}

try {
  const { targetInfos } = await call("Target.getTargets");
  const { targetId } = targetInfos.find(({ type }) => type === "page");
  ({ sessionId } = await call("Target.attachToTarget", { targetId, flatten: true }));
  for (const domain of ["Page", "Runtime", "DOM", "Network"]) await call(`${domain}.enable`);
  await call("Page.navigate", { url: page.startsWith("http") ? page : pathToFileURL(page).href });
  await after(0);
  const found = [];
  for (const step of steps) found.push(await take(step));
  console.log(JSON.stringify({ found, logged }));
} finally {
  child.kill();
  await new Promise(ended => child.once("exit", ended));
  await removeProfile();
}
