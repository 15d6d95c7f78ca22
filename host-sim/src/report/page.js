import { STOPS, colour, inMetres, percent, ringStep } from "./drawing.js";
const SVG = "http://www.w3.org/2000/svg";
const setup = JSON.parse(document.getElementById("setup").textContent);
const frames = JSON.parse(document.getElementById("data").textContent);
const $ = id => document.getElementById(id);
// Fields of a segment, in this order.
const segmentOf = ([x0, y0, x1, y1, d0, d1, sigma, confidence, owner, z0, z1, sz0, sz1, feature, window, census, tests], id) =>
  ({ id, x0, y0, x1, y1, d0, d1, sigma, confidence, owner, z0, z1, sz0, sz1, feature, window, census, tests });
// Of a bar; x and y are those of its left edge.
const barOf = ([x0, y0, x1, y1, width, d0, d1, sigma, confidence, z0, z1, sz0, sz1, tests], id) =>
  ({ id, x0, y0, x1, y1, width, d0, d1, sigma, confidence, z0, z1, sz0, sz1, tests, isBar: true });
const rejectedOf = ([x0, y0, x1, y1, reason, tests], id) => ({ id, x0, y0, x1, y1, reason, tests, isRejected: true });

let frame = null;          // what is shown
let chosen = null;         // a segment or a bar
let onlyReason = null;     // position in setup.reasons
let isUnfolded = false;    // the tests of a segment
let parts = { left: [], right: [], top: [] };

function element(parent, name, attributes = {}, text) {
  const isSvg = parent instanceof SVGElement || name === "svg";
  const made = isSvg ? document.createElementNS(SVG, name) : document.createElement(name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== undefined) made.textContent = text;
  parent.append(made);
  return made;
}

const isFlat = s => Math.abs(s.x1 - s.x0) > 4 * Math.abs(s.y1 - s.y0);
const middle = s => 0.5 * (s.d0 + s.d1);
const px = v => v === null ? "–" : `${v.toFixed(2)} px`;
const shade = d => colour(d, frame.range);
const sure = v => v > 0.999 ? "above 99.9 %" : percent(v);
const metres = v => inMetres(v ?? Infinity);

function line(s, shift) {
  const [a, b] = shift ? [s.d0, s.d1] : [0, 0];
  return `M${s.x0 - a} ${s.y0}L${s.x1 - b} ${s.y1}`;
}

// Both edges, joined at the ends.
function outline(b, shift) {
  const [d0, d1] = shift ? [b.d0, b.d1] : [0, 0];
  return `M${b.x0 - d0} ${b.y0}L${b.x1 - d1} ${b.y1}h${b.width}L${b.x0 - d0 + b.width} ${b.y0}Z`;
}

// Short strokes towards the side or sides that own the disparity.
function ticks(s, shift) {
  const [a, b] = shift ? [s.d0, s.d1] : [0, 0];
  const [x0, x1] = [s.x0 - a, s.x1 - b], dx = x1 - x0, dy = s.y1 - s.y0, length = Math.hypot(dx, dy);
  if (!length) return "";
  let [nx, ny] = [-dy / length, dx / length];
  if (isFlat(s) ? ny > 0 : nx > 0) [nx, ny] = [-nx, -ny];
  const sides = { left: [1], right: [-1], both: [1, -1] }[s.owner], count = Math.max(1, Math.round(length / 5));
  let path = "";
  for (let i = 0; i < count; i++) {
    const t = (i + 0.5) / count;
    for (const side of sides) path += `M${(x0 + t * dx).toFixed(2)} ${(s.y0 + t * dy).toFixed(2)}l${(2 * side * nx).toFixed(2)} ${(2 * side * ny).toFixed(2)}`;
  }
  return path;
}

function drawImage(side) {
  const stage = $(side), shift = side === "right", [w, h] = frame.size;
  stage.replaceChildren();
  element(stage, "img", { src: frame.images[shift ? 1 : 0], alt: `${side} image, ${w} by ${h} pixels` });
  // Whole numbers are centres of pixels.
  const svg = element(stage, "svg", { viewBox: `-0.5 -0.5 ${w} ${h}`, "aria-hidden": "true" });
  if (!shift && $("show-objects").checked) drawObjects(svg, w);
  parts[side] = new Map();
  if ($("show-rejected").checked && !shift) {
    for (const s of frame.rejected) {
      if (onlyReason !== null && s.reason !== onlyReason) continue;
      parts[side].set(s, element(svg, "path", { d: line(s, false), class: "rejected" }));
    }
  }
  if ($("show-matched").checked) {
    for (const s of [...frame.segments].reverse()) {
      const made = element(svg, "path", { d: line(s, shift) + ticks(s, shift), class: "segment" + (onlyReason === null ? "" : " dim"), stroke: shade(middle(s)) });
      if (s.confidence < 0.9) made.setAttribute("stroke-dasharray", "5 4");
      parts[side].set(s, made);
    }
    for (const b of frame.bars) parts[side].set(b, element(svg, "path", { d: outline(b, shift), class: "outline" + (onlyReason === null ? "" : " dim"), stroke: shade(middle(b)) }));
  }
}

function drawObjects(svg, width) {
  for (const o of frame.objects) {
    if (o.is_box) {
      const [x, y, w, h] = o.cover[0];
      element(svg, "rect", { x: x - 0.5, y: y - 0.5, width: w, height: h, class: "cover box" });
    } else {
      element(svg, "path", { d: o.cover.map(([x, y, w]) => `M${x - 0.5} ${y - 0.5}h${w}v1h${-w}z`).join(""), class: "cover" });
    }
    const box = o.cover.reduce((b, [x, y]) => [Math.min(b[0], x), Math.min(b[1], y)], [Infinity, Infinity]);
    const size = width / 40, text = element(svg, "text", { class: "name", transform: `translate(${box[0] + 0.3 * size} ${box[1] + 1.1 * size}) scale(${size})` });
    text.textContent = `${objectName(o)} ${o.depth_m !== null ? metres(o.depth_m) : o.disparity_px !== null ? px(o.disparity_px) : "?"}`;
  }
}

const objectName = o => o.name ?? `#${o.label}`;

// ---- from above

function quantile(values, share) {
  const sorted = [...values].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}

function drawAbove() {
  const box = $("top");
  box.replaceChildren();
  parts.top = new Map();
  const say = text => element(box, "p", { class: "faint" }, text);
  if (!frame.has_depth) return say("Metres need a rig: give --focal-px and --baseline-m, --scene, or --rig.");
  if (!frame.pinhole) return say("Directions need a focal length: only the product of focal length and baseline is known.");
  const [f, cx] = frame.pinhole, across = (x, z) => (x - cx) * z / f;
  const placed = frame.segments.filter(s => s.z0 !== null && s.z1 !== null);
  const depths = [...placed.flatMap(s => [s.z0, s.z1]), ...frame.points.filter(p => p[3] !== null).map(p => p[3])];
  if (!depths.length) return say("Nothing was placed.");
  // Points seen through a window should not make the room small.
  const far = 1.2 * quantile(depths, 0.93), [w] = frame.size;
  const edges = [across(-0.5, far), across(w - 0.5, far)], half = 1.08 * Math.max(-edges[0], edges[1], 0.22 * far);
  const W = 720, scale = Math.min((W - 20) / (2 * half), 520 / far), H = far * scale + 46;
  const at = (x, z) => [W / 2 + x * scale, H - 30 - z * scale];
  const svg = element(box, "svg", { viewBox: `0 0 ${W} ${H.toFixed(0)}`, role: "img", "aria-label": `Seen from above, to ${far.toFixed(1)} m` });
  const [ox, oy] = at(0, 0), corner = edges.map(x => at(x, far).map(v => v.toFixed(1)).join(" "));
  element(svg, "path", { class: "view", d: `M${ox} ${oy}L${corner[0]}L${corner[1]}Z` });
  for (let z = ringStep(far, 5), step = z; z < far; z += step) {
    const r = z * scale, dx = Math.min(r, W / 2), dz = Math.sqrt(r * r - dx * dx);
    element(svg, "path", { class: "ring", d: `M${ox - dx} ${oy - dz}A${r} ${r} 0 0 1 ${ox + dx} ${oy - dz}` });
  }
  const bins = new Map();
  for (const [x, , d, z] of frame.points) {
    if (z === null || z > far) continue;
    const key = shade(Math.round(d)), [u, v] = at(across(x, z), z);
    bins.set(key, `${bins.get(key) ?? ""}M${u.toFixed(1)} ${v.toFixed(1)}h0`);
  }
  for (const [stroke, d] of bins) element(svg, "path", { class: "point", stroke, d });
  const beyond = placed.filter(s => Math.max(s.z0, s.z1) > far);
  if (beyond.length) say(`${beyond.length} segments lie beyond, up to ${metres(Math.max(...beyond.flatMap(s => [s.z0, s.z1])))}.`);
  for (const s of [...placed].reverse()) {
    if (beyond.includes(s)) continue;
    const [u0, v0] = at(across(s.x0, s.z0), s.z0), [u1, v1] = at(across(s.x1, s.z1), s.z1);
    const made = element(svg, "path", { class: "segment", stroke: shade(middle(s)), d: `M${u0.toFixed(1)} ${v0.toFixed(1)}L${u1.toFixed(1)} ${(v1 + 0.01).toFixed(2)}` });
    parts.top.set(s, made);
  }
  for (const o of frame.objects) {
    if (o.depth_m === null) continue;
    const [left, right] = o.cover.reduce((b, [x, , w]) => [Math.min(b[0], x - 0.5), Math.max(b[1], x + w - 0.5)], [Infinity, -Infinity]);
    const z = o.depth_m, [u0, v0] = at(across(left, z), z + o.sigma_m), [u1, v1] = at(across(right, z), Math.max(0, z - o.sigma_m));
    element(svg, "rect", { class: "object", x: u0, y: v0, width: u1 - u0, height: Math.max(2, v1 - v0) });
    element(svg, "text", { class: "object-name", x: u0, y: v0 - 4 }, `${objectName(o)} ${metres(z)}`);
  }
  for (let z = ringStep(far, 5), step = z; z < far; z += step) {
    element(svg, "text", { class: "range", x: ox + 4, y: oy - z * scale - 4 }, `${+z.toFixed(3)} m`);
  }
  element(svg, "path", { class: "camera", d: `M${ox} ${oy}l-7 12h14z` });
}

// ---- lists

function drawLists() {
  const objects = $("objects");
  $("objects-section").hidden = $("objects-label").hidden = !frame.objects.length;
  objects.replaceChildren();
  if (frame.objects.length) {
    const head = element(objects, "tr");
    for (const [name, isNumber] of [["object", 0], ["depth", 1], ["disparity", 1], ["nearest", 1], ["segments", 1], ["confidence", 1]]) element(head, "th", isNumber ? { class: "number" } : {}, name);
    for (const o of frame.objects) {
      const row = element(objects, "tr"), number = { class: "number" };
      element(row, "td", {}, objectName(o));
      element(row, "td", number, o.reason ? o.reason.replaceAll("_", " ") : o.depth_m === null ? "–" : `${metres(o.depth_m)} ± ${o.sigma_m?.toFixed(3) ?? "∞"}`);
      element(row, "td", number, o.disparity_px === null ? "–" : `${px(o.disparity_px)} ± ${o.sigma_px.toFixed(2)}`);
      element(row, "td", number, o.nearest_m === null ? "–" : metres(o.nearest_m));
      element(row, "td", number, o.support);
      element(row, "td", number, sure(o.confidence));
    }
  }
  const health = $("health");
  health.replaceChildren();
  if (!frame.health.length) element(health, "li", { class: "good" }, "Nothing is wrong with the pair.");
  for (const [name, what] of frame.health) element(health, "li", { class: "bad" }, `${name.replaceAll("_", " ")}: ${what}`);
  if (frame.rows_px !== null) element(health, "li", { class: "faint" }, `Rows: the right image is ${Math.abs(frame.rows_px).toFixed(2)} px too ${frame.rows_px > 0 ? "low" : "high"}.`);

  const counts = $("counts");
  counts.replaceChildren();
  const reasons = setup.reasons.map(([name]) => name);
  for (const [name, count] of frame.counts) {
    const reason = reasons.indexOf(name);
    if (!count && !["segments_left", "matched"].includes(name)) continue;
    const row = element(counts, "tr"), cell = element(row, "td");
    if (reason < 0) {
      cell.textContent = name.replaceAll("_", " ");
    } else {
      const button = element(cell, "button", { type: "button", "aria-pressed": onlyReason === reason, "data-reason": name, title: setup.reasons[reason][1] }, name.replaceAll("_", " "));
      button.addEventListener("click", () => {
        onlyReason = onlyReason === reason ? null : reason;
        if (onlyReason !== null) $("show-rejected").checked = true;
        choose(null);
        drawImages();
        drawLists();
      });
    }
    element(row, "td", { class: "number" }, count);
  }
}

// ---- what is chosen

function choose(s) {
  chosen = s;
  document.querySelectorAll(".halo").forEach(halo => halo.remove());
  document.querySelectorAll(".chosen").forEach(made => made.classList.remove("chosen"));
  for (const side of ["left", "right", "top"]) {
    const made = s && parts[side].get && parts[side].get(s);
    if (!made) continue;
    const halo = made.cloneNode();
    halo.setAttribute("class", "halo");
    halo.removeAttribute("stroke");
    made.parentNode.append(halo, made);
    made.classList.add("chosen");
  }
  describe(s);
}

function describe(s) {
  const box = $("details");
  box.replaceChildren();
  if (!s) {
    element(box, "p", { class: "faint" }, "Point at a segment or a bar, tap it, or go through them with the arrow keys.");
    return;
  }
  const title = element(box, "h3");
  if (s.isRejected) {
    element(title, "i", { style: "background: var(--rejected)" });
    title.append(`Rejected: ${setup.reasons[s.reason][0].replaceAll("_", " ")}`);
    element(box, "p", {}, setup.reasons[s.reason][1]);
    putTests(box, s);
    return;
  }
  element(title, "i", { style: `background: ${shade(middle(s))}` });
  title.append(`${s.isBar ? "Bar" : "Segment"} ${s.id}`);
  const list = element(box, "dl");
  const put = (name, value) => {
    const pair = element(list, "div");
    element(pair, "dt", {}, name);
    element(pair, "dd", { "data-field": name }, value);
  };
  const from = (a, b, unit) => a === b ? unit(a) : `${unit(a)} to ${unit(b)}`;
  put("disparity", from(s.d0, s.d1, px));
  if (frame.has_depth) put("depth", from(s.z0, s.z1, metres));
  put("uncertainty", `± ${s.sigma.toFixed(2)} px` + (s.sz0 !== null && frame.has_depth ? `, ± ${Math.max(s.sz0, s.sz1 ?? 0).toFixed(3)} m` : ""));
  put("confidence", sure(s.confidence));
  if (s.isBar) {
    put("width", px(s.width));
    putTests(box, s);
    return;
  }
  const names = isFlat(s) ? { left: "above", right: "below", both: "both sides" } : { left: "left side", right: "right side", both: "both sides" };
  put("owner", names[s.owner]);
  put("feature", px(s.feature));
  put("window", px(s.window));
  put("census", px(s.census));
  putTests(box, s);
}

// Every test with its number and limit, as `linestereo explain` has them.
function putTests(box, s) {
  if (!s.tests) return;
  const more = element(box, "details", isUnfolded ? { open: "" } : {});
  more.addEventListener("toggle", () => { isUnfolded = more.open; });
  element(more, "summary", {}, "Tests");
  element(more, "pre", { "data-field": "tests" }, s.tests);
}

// From a segment, or from the middle of a bar.
function distance(s, shift, x, y) {
  const [a, b] = shift ? [s.d0, s.d1] : [0, 0], aside = (s.width ?? 0) / 2;
  const x0 = s.x0 - a + aside, dx = s.x1 - b + aside - x0, dy = s.y1 - s.y0;
  const t = Math.max(0, Math.min(1, ((x - x0) * dx + (y - s.y0) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - x0 - t * dx, y - s.y0 - t * dy);
}

// The nearest segment or bar within reach; a rejected one only where it is clearly nearer.
function pick(side, event) {
  const rect = $(side).getBoundingClientRect(), scale = frame.size[0] / rect.width, shift = side === "right";
  const x = (event.clientX - rect.left) * scale - 0.5, y = (event.clientY - rect.top) * scale - 0.5;
  let best = null, least = (event.pointerType === "touch" ? 26 : 14) * scale;
  for (const s of parts[side].keys()) {
    const d = distance(s, shift, x, y) + (s.isRejected && onlyReason === null ? 3 * scale : 0);
    if (d < least) [best, least] = [s, d];
  }
  return best;
}

function step(by) {
  const rank = s => (s.isRejected ? 2 : s.isBar ? 1 : 0);
  const list = [...parts.left.keys()].sort((a, b) => rank(a) - rank(b) || a.id - b.id);
  if (!list.length) return;
  const now = list.indexOf(chosen);
  choose(list[now < 0 ? (by > 0 ? 0 : list.length - 1) : (now + by + list.length) % list.length]);
}

for (const side of ["left", "right"]) {
  const stage = $(side);
  for (const name of ["pointermove", "pointerdown"]) {
    stage.addEventListener(name, event => {
      const found = frame.error ? null : pick(side, event);
      if (found !== chosen && (found || name === "pointerdown")) choose(found);
    });
  }
  stage.addEventListener("keydown", event => {
    const by = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 }[event.key];
    if (by) step(by);
    else if (event.key === "Escape") choose(null);
    else return;
    event.preventDefault();
  });
}

// ---- frames

function drawImages() {
  drawImage("left");
  drawImage("right");
}

function show(index) {
  frame = frames[index];
  // Once a frame is looked at, its lists become records.
  if (!frame.error && !frame.ready) {
    frame.segments = frame.segments.map(segmentOf);
    frame.bars = frame.bars.map(barOf);
    frame.rejected = frame.rejected.map(rejectedOf);
    frame.ready = true;
  }
  chosen = null;
  document.querySelector("main").hidden = Boolean(frame.error);
  $("error").hidden = !frame.error;
  $("frame").value = index;
  $("frame-name").textContent = `${index + 1} of ${frames.length}: ${frame.name}`;
  if (frame.error) {
    $("error").textContent = frame.error;
    $("summary").textContent = "";
    return;
  }
  const count = Object.fromEntries(frame.counts), [w, h] = frame.size;
  $("summary").textContent = `${w} × ${h} px, disparities below ${frame.max_disparity} px: ${count.matched} of ${count.segments_left} segments matched, ${count.points} points, ${frame.bars.length} bars`;
  $("legend").replaceChildren();
  const [far, near] = frame.range;
  element($("legend"), "span", {}, `${far} px, far`);
  element($("legend"), "i", { style: `background: linear-gradient(to right, ${STOPS.map(c => `rgb(${c})`).join(",")})` });
  const ends = frame.segments.flatMap(segment => [segment.d0, segment.d1]), beyond = ends.filter(d => d < far || d > near).length;
  element($("legend"), "span", {}, `near, ${near} px${beyond ? `; ${beyond} ends of segments beyond these colours` : ""}`);
  drawImages();
  drawAbove();
  drawLists();
  describe(null);
}

for (const id of ["show-matched", "show-rejected", "show-objects"]) {
  $(id).addEventListener("change", () => {
    if (id === "show-rejected" && !$(id).checked) onlyReason = null;
    choose(null);
    drawImages();
    drawLists();
  });
}
$("title").textContent = setup.title;
$("footer").textContent = `linestereo ${setup.version}`;
$("frames").hidden = frames.length < 2;
$("frame").max = frames.length - 1;
$("frame").addEventListener("input", event => show(Number(event.target.value)));
for (const [id, by] of [["previous", -1], ["next", 1]]) {
  $(id).addEventListener("click", () => show((Number($("frame").value) + by + frames.length) % frames.length));
}
show(0);
