import { dimmed, drawPair, drawTop, inMetres, inWords, item, onBoxes, range, showLegend } from "./drawing.js";
// The live page: events of the program -> a pair with what was matched, its points from above,
// depths of boxes, health, and what came each second.

const $ = id => document.getElementById(id);
const words = JSON.parse($("words").textContent), advice = new Map(words.flags), reasons = new Map(words.reasons);
const query = `?token=${new URLSearchParams(location.search).get("token")}`;
/// Seconds that are charted, notes that are kept, side of the square of a point, px.
const SECONDS = 60, MOST_NOTES = 20, SIDE = 2;
/// Boxes that are asked for at the same time.
const MOST_BOXES = words.most_boxes;

let frame = null;         // the last one, with its picture, segments, bars and points
let picture = null;       // of the frame that comes next
let above = [], sectors = [], yaw = 0; // where the camera looks, degrees clockwise from ahead
let boxes = [];           // as they are asked for, in px of the left image, ends exclusive
let answers = null;       // the boxes that the last pair was asked for, and their depths
let dragged = null;
let came = 0;             // frames of this second
let counts = null, before = null; // of the link: the last ones, and those of the second before
const history = { rate: [], lost: [] };

/// Draws what is new when the browser shows its next picture: not more often than anybody sees.
let isDue = false;
function due() {
  if (isDue) return;
  isDue = true;
  requestAnimationFrame(() => { isDue = false; show(); });
}

// ---- events

const events = new EventSource(`/events${query}`);
const on = (name, take) => events.addEventListener(name, ({ data }) => { take(JSON.parse(data)); due(); });
let isEnded = false;
events.onopen = () => { $("error").hidden = true; };
events.onerror = () => {
  if (isEnded) events.close();
  else say("The program does not answer; it is tried again. If it has ended, start it, and open the address that it prints.");
};
function say(text) {
  $("error").hidden = false;
  $("error").textContent = text;
}

on("picture", ({ size: [width, height], grey }) => {
  if ($("hold").checked) return;
  picture = { width, height, canvas: dimmed(Uint8Array.from(atob(grey), letter => letter.charCodeAt(0)), width, height) };
});
on("frame", line => {
  came += 1;
  document.body.dataset.done = Number(document.body.dataset.done ?? 0) + 1;
  if ($("hold").checked) return;
  const name = line.name ?? `${line.sequence}`;
  if (line.error) return note(`${name}: ${line.error}`);
  const placed = ({ left: [[x0, y0], [x1, y1]], width_px, disparity_px }) => ({ x: [x0, x1], y: [y0, y1], wide: width_px, disparity: disparity_px });
  const segments = line.segments.map(placed), bars = (line.bars ?? []).map(placed);
  const points = (line.points ?? []).map(([x, y, disparity]) => ({ x, y, disparity }));
  frame = { line, name, width: line.size[0], height: line.size[1], segments, bars, points, picture: picture?.canvas ?? null, ground: line.ground ?? null };
});
on("above", ({ points, rig, yaw_deg }) => {
  yaw = yaw_deg;
  if ($("hold").checked) return;
  above = points.map(([x, z, disparity]) => ({ x, z, disparity }));
  if (frame) frame.rig = rig;
});
on("sectors", list => {
  if ($("hold").checked) return;
  const half = Math.PI / 180 * (list.length > 1 ? 180 / list.length : 2.5);
  const arc = ({ direction_deg }, distance, isEdge) => {
    const middle = Math.PI / 180 * (direction_deg - yaw);
    return { from: middle - half, to: middle + half, distance, isEdge };
  };
  sectors = [
    ...list.filter(one => one.state === "obstacle").map(one => arc(one, one.distance_m, false)),
    ...list.filter(one => one.drop_off_m !== null).map(one => arc(one, one.drop_off_m, true)),
  ];
});
on("objects", found => { answers = found; });
on("boxes", list => { boxes = list.map(([left, top, right, bottom]) => ({ left, top, right, bottom })); });
// What was lost before this page was opened is not charted.
on("link", found => { before ??= found; counts = found; });
on("note", note);
on("dropped", count => note(`this page was too slow: ${count} messages are left out`));
on("end", summary => {
  isEnded = true;
  say("The program has ended. Start it again, and open the address that it prints.");
  summary.split("\n").filter(Boolean).forEach(note);
});

function note(text) {
  $("notes").prepend(item(text, ""));
  while ($("notes").children.length > MOST_NOTES) $("notes").lastChild.remove();
}

// ---- boxes

function ask(list) {
  const last = boxes;
  boxes = list;
  const refused = why => {
    note(why);
    if (boxes === list) boxes = last;
    due();
  };
  const body = JSON.stringify(boxes.map(({ left, top, right, bottom }) => [left, top, right, bottom]));
  fetch(`/boxes${query}`, { method: "POST", body }).then(answer => (answer.ok ? null : answer.text().then(refused)), () => refused("the boxes were not taken"));
  due();
}

function answerOf({ left, top, right, bottom }) {
  const at = answers?.boxes.findIndex(box => String(box) === String([left, top, right, bottom])) ?? -1;
  return at < 0 ? "not known" : inPageWords(answers.objects[at]);
}

function inPageWords({ disparity_px, sigma_px, depth_m, sigma_m, nearest_m, confidence, reason }) {
  const far = metres => metres ?? Infinity;
  const found = { reason: reasons.get(reason) ?? reason, disparity: disparity_px, sigma: sigma_px, confidence, depth: far(depth_m), depth_sigma: far(sigma_m), nearest: far(nearest_m) };
  return inWords(found, answers.rig);
}

function list() {
  // A board may be asked for others by --send.
  const others = (answers?.objects ?? []).slice(answers?.boxes.length).map(object => item(`object ${object.label}: ${inPageWords(object)}`, ""));
  $("objects").replaceChildren(...boxes.map((box, i) => {
    const made = item(answerOf(box), ""), remove = document.createElement("button");
    remove.textContent = "remove";
    remove.addEventListener("click", () => ask(boxes.filter((_, other) => other !== i)));
    made.append(remove);
    return made;
  }), ...others);
}

onBoxes($("left"), () => [frame?.width ?? 1, frame?.height ?? 1], box => { dragged = box; due(); }, box => {
  if (boxes.length === MOST_BOXES) note(`at most ${MOST_BOXES} boxes; remove one`);
  else if (frame) ask([...boxes, box]);
});
for (const id of ["show-segments", "show-bars", "show-points", "hold"]) $(id).addEventListener("change", due);

// ---- what is shown

function show() {
  list();
  if (!frame) return;
  const { line, name, width, segments, bars, points } = frame, span = range(segments, 64);
  const time = line.times_us ? `, matched in ${(line.times_us.matching / 1000).toFixed(1)} ms` : "";
  // A board sends no bars.
  const ofBars = line.bars ? `, ${bars.length} bars` : "";
  $("summary").textContent = `${name}: ${width}x${frame.height}, ${line.counts.matched} segments matched, ${points.length} points${ofBars}${time}`;
  $("health").replaceChildren(...line.health.flags.map(flag => item(`${flag}: ${advice.get(flag) ?? ""}`, "bad")));
  const shown = { points: $("show-points").checked ? points : [], side: SIDE, segments: $("show-segments").checked ? segments : [], bars: $("show-bars").checked ? bars : [] };
  drawPair($("left"), frame, { ...shown, boxes: [...boxes, ...(dragged ? [dragged] : [])], span });
  const metres = frame.rig && span.map(d => (d + frame.rig.offset > 0 ? inMetres(frame.rig.product / (d + frame.rig.offset)) : "∞"));
  showLegend($("legend"), metres ?? span.map(d => `${d} px`), segments, span, frame.ground);
  $("top-note").textContent = !frame.rig ? "Metres and directions need focal length and baseline." : above.length || sectors.length ? "" : "Nothing was placed.";
  drawTop($("top"), above, span, sectors);
}

/// A line over the last minute, from 0 to its largest value.
function chart(canvas, values) {
  const context = canvas.getContext("2d"), { width, height } = canvas, most = Math.max(1, ...values), ink = getComputedStyle(document.body);
  context.clearRect(0, 0, width, height);
  context.strokeStyle = context.fillStyle = ink.getPropertyValue("--accent");
  context.font = "13px system-ui, sans-serif";
  context.lineWidth = 2;
  context.beginPath();
  values.forEach((value, i) => context.lineTo(width - (values.length - 1 - i) * width / (SECONDS - 1), height - 4 - value / most * (height - 26)));
  context.stroke();
  context.fillText(`now ${values.at(-1)}, most ${most}`, 8, 15);
}

setInterval(() => {
  const lost = ["lost", "missing_segments", "damaged"].reduce((sum, name) => sum + (counts?.[name] ?? 0) - (before?.[name] ?? 0), 0);
  for (const [id, value] of [["rate", came], ["lost", lost]]) {
    history[id] = [...history[id], value].slice(-SECONDS);
    chart($(id), history[id]);
  }
  [came, before] = [0, counts];
  $("counts").replaceChildren(...Object.entries(counts ?? {}).flatMap(([name, value]) => ["dt", "dd"].map((tag, i) => {
    const made = document.createElement(tag);
    made.textContent = i === 0 ? name.replaceAll("_", " ") : value;
    return made;
  })));
}, 1000);

/// For the console: `linestereo.line()` is the last frame as the program has it.
globalThis.linestereo = { size: () => [frame.width, frame.height], line: () => frame.line };
