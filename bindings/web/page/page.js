import { Images, Matcher, Refused, csv } from "./linestereo.js";
import { dimmed, drawPair, drawTop, inMetres, inPixels, inWords, item, onBoxes, range, showLegend } from "../../../host-sim/src/report/drawing.js";
// The page: files or a camera -> a pair -> what was matched, drawn, with the depth of boxes.

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
let picture = null;        // the left image, without anything on it
let stream = null;         // of the camera

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
  for (const field of $("settings").elements) {
    if (!field.checkValidity()) throw new Refused(`${field.labels[0].textContent.trim()}: ${field.validationMessage}`);
  }
  const number = id => ($(id).value === "" ? 0 : Number($(id).value));
  const [focal_px, baseline_m] = [number("focal"), number("baseline")];
  if ((focal_px === 0) !== (baseline_m === 0)) throw new Refused("metres need both, focal length and baseline; give the other one, or neither");
  return { max_disparity: number("max-disparity"), width: number("width"), both: $("both").checked, rig: focal_px ? { focal_px, baseline_m } : null };
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
  pair = images.pair(settings().width, settings().both);
  await match(true);
}

// ---- matching

/// `anew`: the pair is no next one of a sequence.
async function match(anew) {
  const { max_disparity, rig: given } = settings(), { width, height, scale } = pair;
  if (Math.max(width, height) > LARGEST) throw new Refused(`${width}x${height} is more than ${LARGEST}x${LARGEST}; reduce it to a width below`);
  const rig = given && { ...given, focal_px: given.focal_px * scale };
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

/// Runs a module that is new until it is compiled for speed: else the time of compiling would be
/// said.
async function warm(parameters) {
  if (modules.areWarm) return;
  const other = await Matcher.make(modules.matcher, parameters);
  for (const end = performance.now() + 300; performance.now() < end; await new Promise(next => setTimeout(next))) other.run(pair.left, pair.right);
  modules.areWarm = true;
}

// ---- what is shown

function show() {
  document.querySelector("main").hidden = false;
  const { segments, points, health, milliseconds } = result;
  $("summary").textContent = `${pair.width}x${pair.height}: ${health.matched} of ${health.found} segments matched, ${points.length} points, ${milliseconds.toFixed(1)} ms`;
  const cut = files.length === 1 ? ", cut in the middle: left | right." : "";
  $("names").textContent = [stream ? "Camera, both side by side" : files.map(file => file.name).join(" | ") + cut, decodedBy].join(" ");
  $("swap").hidden = files.length !== 2 || stream !== null;
  const faults = health.is_cut ? [...health.names, "segments_dropped"] : health.names;
  $("health").replaceChildren(...faults.map(name => item(`${name}: ${advice.get(name) ?? ""}`, "bad")));
  picture = dimmed(pair.left, pair.width, pair.height);
  draw();
  showTop(points);
  const [far, near] = range(segments, settings().max_disparity);
  const ends = matcher.rig ? [far, near].map(d => (d > 0 ? inMetres(matcher.rig.focal_px * matcher.rig.baseline_m / d) : "∞")) : [`${far} px`, `${near} px`];
  showLegend($("legend"), ends, segments, [far, near]);
  list();
}

function list() {
  $("objects").replaceChildren(...boxes.map((box, i) => {
    const made = item(inWords(matcher.box(box), matcher.rig), ""), remove = document.createElement("button");
    remove.textContent = "remove";
    remove.setAttribute("aria-label", `remove box ${i + 1}`);
    remove.addEventListener("click", () => { boxes.splice(i, 1); list(); draw(); $("left").focus({ preventScroll: true }); });
    made.append(remove);
    return made;
  }));
}

function draw() {
  const points = $("show-support").checked ? result.points.filter(point => point.segment === SUPPORT_POINT) : [];
  const segments = $("show-segments").checked ? result.segments : [], span = range(result.segments, settings().max_disparity);
  drawPair($("left"), { ...pair, picture }, { points, side: CELL, segments, boxes: [...boxes, ...(dragged ? [dragged] : [])], span });
}

function showTop(points) {
  const { rig, width } = matcher;
  const placed = !rig ? [] : points.filter(p => p.disparity > 0).map(({ x, disparity }) => {
    const z = rig.focal_px * rig.baseline_m / disparity;
    return { x: (x - (width - 1) / 2) * z / rig.focal_px, z, disparity };
  });
  $("top-note").textContent = !rig ? "Metres need focal length and baseline." : placed.length ? `${placed.length} points, the nearest at ${inMetres(placed.reduce((least, { z }) => Math.min(least, z), Infinity))}.` : "Nothing was placed.";
  drawTop($("top"), placed, range(result.segments, settings().max_disparity));
}

// ---- a camera that gives both images side by side

async function startCamera() {
  if (stream) return; // asked for twice
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
        pair = images.pair(settings().width, true);
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
  const chosen = ordered(list);
  next(async () => {
    stopCamera(); // also one that was asked for before
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

onBoxes($("left"), () => [pair.width, pair.height], box => { dragged = box; $("box").textContent = inPixels(box); draw(); }, box => { boxes.push(box); list(); });

next(async () => {
  if (typeof DecompressionStream === "undefined" || typeof WebAssembly === "undefined") throw new Refused("this browser is too old; use one of 2023 or later");
  const [matching, reading] = await Promise.all(["matcher-module", "images-module"].map(compiled));
  modules = { matcher: matching, images: reading };
  images = await Images.make(reading);
});
/// For the console: `linestereo.result()` is everything that was found.
globalThis.linestereo = { size: () => [pair.width, pair.height], result: () => result, csv: () => csv(result), box: box => matcher.box(box) };
