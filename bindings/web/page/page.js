import { Images, Matcher, Refused, csv } from "./linestereo.js";
// The page: files or a camera -> a pair -> what was matched, drawn, with the depth of boxes.

const STOPS = [[70, 110, 255], [0, 200, 255], [70, 225, 110], [255, 225, 40], [255, 140, 20], [255, 45, 45]];
/// Largest side that the core takes, px, and bytes of a file that are read.
const LARGEST = 1280, FILE_BYTES = 2 ** 27;
/// Side of the square that a support point stands for, px.
const CELL = 8;
const SUPPORT_POINT = -2;
const $ = id => document.getElementById(id);
const advice = new Map(JSON.parse($("advice").textContent));

let modules = null;        // compiled
let images = null;         // the reader of the files that are shown, or of the camera
let files = [];            // left and right, or both side by side
let decodedBy = "";        // a note about files that the browser decoded
let pair = null, matcher = null, result = null;
let boxes = [];            // in px of the left image, ends exclusive
let dragged = null;        // the box that is being drawn
let stream = null;         // of the camera
let ours = document.createElement("canvas"); // the left image, without anything on it

async function compiled(id) {
  const bytes = Uint8Array.from(atob($(id).textContent), letter => letter.charCodeAt(0));
  const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return WebAssembly.compile(await new Response(plain).arrayBuffer());
}

function say(error) {
  // What nobody refused is a defect of the page: it is said, too, and looked at in the console.
  if (error && !(error instanceof Refused)) console.error(error);
  $("error").hidden = !error;
  $("error").textContent = error ? error.message : "";
  if (error) document.querySelector("main").hidden = true;
}

/// One after the other: a file that is chosen meanwhile comes next.
let last = Promise.resolve();
function next(work) {
  last = last.then(work).then(() => say(null), say).finally(() => (document.body.dataset.done = Number(document.body.dataset.done ?? 0) + 1));
}

// ---- images

const isOurs = bytes => (bytes[0] === 0x89 && bytes[1] === 0x50) || (bytes[0] === 0x50 && (bytes[1] === 0x35 || bytes[1] === 0x36));

async function add(file) {
  if (file.size > FILE_BYTES) throw new Refused(`${file.name} has more than 128 MiB; give a smaller image`);
  const bytes = new Uint8Array(await file.arrayBuffer());
  try {
    if (isOurs(bytes)) return images.addFile(bytes);
    const { data, width, height } = await shown(file);
    images.addPixels(data, width, height);
    decodedBy = "Decoded by this browser: grey levels may differ from the PC program's by a few, and so may results. Of PNG they do not.";
  } catch (error) {
    throw error instanceof Refused ? new Refused(`${file.name}: ${error.message}`) : error;
  }
}

/// Pixels of a file by the browser's own decoder, not converted to the screen's colours.
async function shown(file) {
  let bitmap;
  try {
    bitmap = await createImageBitmap(file, { colorSpaceConversion: "none", premultiplyAlpha: "none" });
  } catch {
    throw new Refused("not an image that is read; give PNG, PGM, or what this browser shows, such as JPEG");
  }
  if (bitmap.width * bitmap.height > 2 ** 25) throw new Refused("an image of more than 33 million pixels is not read; give a smaller one");
  return pixelsOf(bitmap, bitmap.width, bitmap.height);
}

function pixelsOf(source, width, height) {
  const canvas = new OffscreenCanvas(width, height), context = canvas.getContext("2d", { willReadFrequently: true });
  context.drawImage(source, 0, 0);
  return context.getImageData(0, 0, width, height);
}

function settings() {
  const number = id => ($(id).value === "" ? 0 : Number($(id).value));
  const [focal_px, baseline_m] = [number("focal"), number("baseline")];
  if ((focal_px === 0) !== (baseline_m === 0)) throw new Refused("metres need both, focal length and baseline; give the other one, or neither");
  return { max_disparity: number("max-disparity"), width: number("width"), rig: focal_px ? { focal_px, baseline_m } : null };
}

/// Left before right by name, else as the names are sorted.
function ordered(list) {
  const isRight = file => /right/i.test(file.name);
  return [...list].sort((a, b) => isRight(a) - isRight(b) || a.name.localeCompare(b.name, "en"));
}

async function loadFiles() {
  decodedBy = "";
  await images.forget();
  for (const file of files) await add(file);
  pair = images.pair(settings().width);
  await match(true);
}

// ---- matching

/// `anew`: the pair is no next one of a sequence.
async function match(anew) {
  const { max_disparity, rig } = settings(), { width, height } = pair;
  if (Math.max(width, height) > LARGEST) throw new Refused(`${width}x${height} is more than ${LARGEST}x${LARGEST}; reduce it to a width below`);
  const key = JSON.stringify([width, height, max_disparity, rig]);
  if (anew || matcher?.key !== key) {
    matcher = null;
    matcher = Object.assign(await Matcher.make(modules.matcher, { width, height, max_disparity, rig }), { key });
  }
  if (anew) await warm({ width, height, max_disparity, rig });
  result = matcher.run(pair.left, pair.right);
  boxes = boxes.filter(box => box.right <= width && box.bottom <= height);
  show();
}

/// Runs a module that is new until it is compiled for speed: else the time of compiling would be said.
async function warm(parameters) {
  if (modules.areWarm) return;
  const other = await Matcher.make(modules.matcher, parameters);
  for (const end = performance.now() + 300; performance.now() < end; await new Promise(next => setTimeout(next))) other.run(pair.left, pair.right);
  modules.areWarm = true;
}

const inMetres = z => (z === Infinity ? "∞" : `${z.toFixed(z < 10 ? 3 : 1)} m`);
const percent = share => `${(100 * share).toFixed(1)} %`;

function depthOf(box) {
  const found = matcher.box(box);
  if (found.reason) return `no depth: ${found.reason}`;
  const sure = `within 1 px with ${percent(found.confidence)}`, disparity = `${found.disparity.toFixed(2)} ± ${found.sigma.toFixed(2)} px`;
  return matcher.rig ? `${inMetres(found.depth)} ± ${inMetres(found.depth_sigma)}, nearest ${inMetres(found.nearest)}; ${disparity}, ${sure}` : `${disparity}, ${sure}`;
}

// ---- what is shown

function show() {
  document.querySelector("main").hidden = false;
  const { segments, points, health, milliseconds } = result;
  $("summary").textContent = `${pair.width}x${pair.height}: ${health.matched} of ${health.found} segments matched, ${points.length} points, ${milliseconds.toFixed(1)} ms`;
  $("names").textContent = [stream ? "Camera, both side by side" : files.map(file => file.name).join(" | "), decodedBy].join(" ");
  $("swap").hidden = files.length !== 2 || stream !== null;
  const faults = health.is_cut ? [...health.names, "segments_dropped"] : health.names;
  $("health").replaceChildren(...faults.map(name => item(`${name}: ${advice.get(name) ?? ""}`, "bad")));
  const rgba = new Uint8ClampedArray(4 * pair.width * pair.height).fill(255);
  // Half as bright, so that colours stand out.
  pair.left.forEach((grey, i) => rgba.fill(grey * 0.62, 4 * i, 4 * i + 3));
  Object.assign(ours, { width: pair.width, height: pair.height });
  ours.getContext("2d").putImageData(new ImageData(rgba, pair.width, pair.height), 0, 0);
  draw();
  drawTop(points);
  const [far, near] = range(segments), bar = document.createElement("i");
  bar.style.background = `linear-gradient(90deg, ${STOPS.map(stop => `rgb(${stop})`).join(",")})`;
  const ends = matcher.rig ? [far, near].map(d => (d > 0 ? inMetres(matcher.rig.focal_px * matcher.rig.baseline_m / d) : "∞")) : [`${far} px`, `${near} px`];
  $("legend").replaceChildren(ends[0], bar, ends[1]);
  list();
}

function item(text, name) {
  const made = document.createElement("li");
  made.textContent = text;
  made.className = name;
  return made;
}

function list() {
  $("objects").replaceChildren(...boxes.map((box, i) => {
    const made = item(depthOf(box), ""), remove = document.createElement("button");
    remove.textContent = "remove";
    remove.addEventListener("click", () => { boxes.splice(i, 1); list(); draw(); });
    made.append(remove);
    return made;
  }));
}

/// Disparities that the colours span: all but one in fifty at each end.
function range(segments) {
  const found = segments.flatMap(segment => segment.disparity).sort((a, b) => a - b), skip = Math.floor(found.length / 50);
  if (!found.length) return [0, settings().max_disparity];
  const far = Math.max(0, 4 * Math.floor(found[skip] / 4));
  return [far, Math.max(far + 4, 4 * Math.ceil(found[found.length - 1 - skip] / 4))];
}

function colour(d, [far, near], alpha = 1) {
  const at = Math.min(1, Math.max(0, (d - far) / (near - far))) * (STOPS.length - 1);
  const i = Math.min(Math.floor(at), STOPS.length - 2), t = at - i;
  return `rgba(${STOPS[i].map((value, k) => Math.round(value * (1 - t) + STOPS[i + 1][k] * t)).join(",")},${alpha})`;
}

function draw() {
  const canvas = $("left"), scale = Math.max(1, Math.round(1280 / pair.width)), context = canvas.getContext("2d"), span = range(result.segments);
  Object.assign(canvas, { width: pair.width * scale, height: pair.height * scale });
  context.imageSmoothingEnabled = false;
  context.scale(scale, scale);
  context.drawImage(ours, 0, 0);
  if ($("show-support").checked) {
    for (const { x, y, disparity, segment } of result.points) {
      if (segment !== SUPPORT_POINT) continue;
      context.fillStyle = colour(disparity, span, 0.3);
      context.fillRect(x - CELL / 2, y - CELL / 2, CELL - 0.5, CELL - 0.5);
    }
  }
  if ($("show-segments").checked) {
    context.lineWidth = 1.2;
    for (const { x, y, disparity } of [...result.segments].reverse()) {
      context.strokeStyle = colour((disparity[0] + disparity[1]) / 2, span);
      context.beginPath();
      // Whole numbers are centres of pixels.
      context.moveTo(x[0] + 0.5, y[0] + 0.5);
      context.lineTo(x[1] + 0.5, y[1] + 0.5);
      context.stroke();
    }
  }
  context.strokeStyle = context.fillStyle = "#fff";
  context.font = `${Math.max(8, pair.width / 32)}px system-ui, sans-serif`;
  [...boxes, ...(dragged ? [dragged] : [])].forEach(({ left, top, right, bottom }, i) => {
    context.strokeRect(left, top, right - left, bottom - top);
    context.fillText(`${i + 1}`, left + 2, top + Math.max(8, pair.width / 32));
  });
}

function drawTop(points) {
  const canvas = $("top"), context = canvas.getContext("2d"), { rig, width } = matcher;
  context.clearRect(0, 0, canvas.width, canvas.height);
  const depths = rig ? points.filter(p => p.disparity > 0).map(p => ({ ...p, z: rig.focal_px * rig.baseline_m / p.disparity })) : [];
  $("top-note").textContent = !rig ? "Metres need focal length and baseline." : depths.length ? "" : "Nothing was placed.";
  if (!depths.length) return;
  // Points seen through a window should not make the room small.
  const far = 1.2 * depths.map(p => p.z).sort((a, b) => a - b)[Math.floor(0.93 * (depths.length - 1))];
  const half = Math.max(0.5 * width / rig.focal_px, 0.25) * far, scale = Math.min(canvas.width / (2 * half), (canvas.height - 30) / far);
  const at = (x, z) => [canvas.width / 2 + x * scale, canvas.height - 20 - z * scale], span = range(result.segments);
  context.strokeStyle = context.fillStyle = "#888";
  context.font = "13px system-ui, sans-serif";
  const rough = far / 4, power = 10 ** Math.floor(Math.log10(rough)), step = [1, 2, 5, 10].map(f => f * power).find(s => s >= rough);
  for (let z = step; z < far; z += step) {
    const [x, y] = at(0, z);
    context.beginPath();
    context.arc(canvas.width / 2, canvas.height - 20, z * scale, Math.PI, 2 * Math.PI);
    context.stroke();
    context.fillText(`${+z.toPrecision(3)} m`, x + 4, y - 3);
  }
  for (const { x, z, disparity } of depths) {
    context.fillStyle = colour(disparity, span, 0.5);
    const [u, v] = at((x - (width - 1) / 2) * z / rig.focal_px, z);
    context.fillRect(u - 1, v - 1, 2, 2);
  }
}

// ---- a camera that gives both images side by side

async function startCamera() {
  if (!navigator.mediaDevices?.getUserMedia) throw new Refused("this browser gives no camera to this page; open it from disk, localhost or https");
  try {
    stream = await navigator.mediaDevices.getUserMedia({ video: { width: { ideal: 1280 } } });
  } catch (error) {
    throw new Refused(`no camera (${error.message}); connect one, and allow it to this page`);
  }
  files = [];
  decodedBy = "";
  await images.forget();
  matcher = null;
  $("camera").textContent = "Stop";
  $("video").srcObject = stream;
  await $("video").play();
  follow();
}

function follow() {
  const video = $("video");
  video.requestVideoFrameCallback(() => {
    if (!stream) return;
    next(async () => {
      if (!stream) return;
      try {
        const { data, width, height } = pixelsOf(video, video.videoWidth, video.videoHeight);
        images.addPixels(data, width, height);
        pair = images.pair(settings().width);
        await match(false);
      } catch (error) {
        stopCamera();
        throw error;
      }
      follow();
    });
  });
}

function stopCamera() {
  stream?.getTracks().forEach(track => track.stop());
  stream = null;
  $("camera").textContent = "Camera";
}

// ---- what the visitor does

function take(list) {
  if (list.length === 0) return;
  stopCamera();
  const chosen = ordered(list);
  next(async () => {
    if (chosen.length > 2) throw new Refused(`${chosen.length} files were given; give left and right, or one with both side by side`);
    files = chosen;
    boxes = [];
    await loadFiles();
  });
}

$("files").addEventListener("change", () => { take($("files").files); $("files").value = ""; });
addEventListener("dragover", event => { event.preventDefault(); $("drop").classList.add("over"); });
addEventListener("dragleave", () => $("drop").classList.remove("over"));
addEventListener("drop", event => { event.preventDefault(); $("drop").classList.remove("over"); take(event.dataTransfer.files); });
$("swap").addEventListener("click", () => next(() => { files.reverse(); return loadFiles(); }));
$("camera").addEventListener("click", () => (stream ? stopCamera() : next(startCamera)));
$("settings").addEventListener("submit", event => event.preventDefault());
$("settings").addEventListener("change", () => { if (files.length > 0) next(loadFiles); });
for (const id of ["show-segments", "show-support"]) $(id).addEventListener("change", draw);
$("save").addEventListener("click", () => {
  const link = Object.assign(document.createElement("a"), { download: "segments.csv", href: URL.createObjectURL(new Blob([csv(result)], { type: "text/csv" })) });
  link.click();
  URL.revokeObjectURL(link.href);
});

function place(event) {
  const area = $("left").getBoundingClientRect(), inside = (value, most) => Math.min(most, Math.max(0, Math.round(value)));
  return [inside((event.clientX - area.left) * pair.width / area.width, pair.width), inside((event.clientY - area.top) * pair.height / area.height, pair.height)];
}

$("left").addEventListener("pointerdown", event => {
  if (event.button !== 0) return;
  $("left").setPointerCapture(event.pointerId);
  const [x, y] = place(event);
  dragged = { from: [x, y], left: x, top: y, right: x, bottom: y };
});
$("left").addEventListener("pointermove", event => {
  if (!dragged) return;
  const [x, y] = place(event), [x0, y0] = dragged.from;
  Object.assign(dragged, { left: Math.min(x, x0), top: Math.min(y, y0), right: Math.max(x, x0), bottom: Math.max(y, y0) });
  draw();
});
$("left").addEventListener("pointerup", () => {
  const box = dragged;
  dragged = null;
  if (box && box.right > box.left && box.bottom > box.top) boxes.push(box);
  list();
  draw();
});
$("left").addEventListener("pointercancel", () => { dragged = null; draw(); });

next(async () => {
  if (typeof DecompressionStream === "undefined" || typeof WebAssembly === "undefined") throw new Refused("this browser is too old; use one of 2023 or later");
  const [matching, reading] = await Promise.all(["matcher-module", "images-module"].map(compiled));
  modules = { matcher: matching, images: reading };
  images = await Images.make(reading);
});
/// For the console: `linestereo.result()` is everything that was found.
globalThis.linestereo = { size: () => [pair.width, pair.height], result: () => result, csv: () => csv(result), box: box => matcher.box(box) };
