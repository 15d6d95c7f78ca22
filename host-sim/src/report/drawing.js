// Drawing that the page for browsers (bindings/web), the live page and that of `report` share: a
// pair with what was matched in it, its points from above, boxes that are drawn.

export const STOPS = [[70, 110, 255], [0, 200, 255], [70, 225, 110], [255, 225, 40], [255, 140, 20], [255, 45, 45]];
const FONT = "system-ui, sans-serif";

export const inMetres = z => (z === Infinity ? "∞" : `${z.toFixed(z < 10 ? 3 : 1)} m`);
export const percent = share => `${(100 * share).toFixed(1)} %`;

/// The depth of an object in words: disparities in px, depths in m where there is a rig.
export function inWords({ reason, disparity, sigma, confidence, depth, depth_sigma, nearest }, rig) {
  if (reason) return `no depth: ${reason}`;
  const sure = `within 1 px with ${percent(confidence)}`, px = `${disparity.toFixed(2)} ± ${sigma.toFixed(2)} px`;
  return rig ? `${inMetres(depth)} ± ${inMetres(depth_sigma)}, nearest ${inMetres(nearest)}; ${px}, ${sure}` : `${px}, ${sure}`;
}

/// A box that is drawn in words; nothing without one.
export const inPixels = box => (box ? `Box: ${box.left},${box.top} to ${box.right},${box.bottom} px` : "");

/// An entry of a list.
export function item(text, name) {
  const made = document.createElement("li");
  made.textContent = text;
  made.className = name;
  return made;
}

/// Disparities that the colours span: all but one segment in fifty at each end; up to `most`
/// without segments.
export function range(segments, most) {
  const found = segments.flatMap(segment => segment.disparity).sort((a, b) => a - b), skip = Math.floor(found.length / 50);
  if (!found.length) return [0, most];
  const far = 4 * Math.floor(found[skip] / 4); // below 0 behind infinity
  return [far, Math.max(far + 4, 4 * Math.ceil(found[found.length - 1 - skip] / 4))];
}

export function colour(d, [far, near], alpha = 1) {
  const at = Math.min(1, Math.max(0, (d - far) / (near - far))) * (STOPS.length - 1);
  const i = Math.min(Math.floor(at), STOPS.length - 2), t = at - i;
  return `rgba(${STOPS[i].map((value, k) => Math.round(value * (1 - t) + STOPS[i + 1][k] * t)).join(",")},${alpha})`;
}

/// Colours of what lies on the ground plane and below it, as of `run --overlay`; that of the
/// disparity elsewhere, and without a plane.
export const FLOOR = "222,214,190", DROP = "255,0,220";
const ON_FLOOR_PX = 0.75, BELOW_PX = 2;
function onGround(plane, places, d, span, alpha = 1) {
  const above = plane ? places.map(([x, y, found]) => found - plane.down_px_per_row * y - plane.across_px_per_column * x - plane.origin_px) : [];
  if (above.length && above.every(px => Math.abs(px) <= ON_FLOOR_PX)) return `rgba(${FLOOR},${alpha})`;
  if (above.length && above.every(px => px <= -BELOW_PX)) return `rgba(${DROP},${alpha})`;
  return colour(d, span, alpha);
}

/// The colours between the words at both ends, and how many of these disparities lie beyond them.
export function showLegend(place, [far, near], segments, span, ground = null) {
  const beyond = segments.flatMap(segment => segment.disparity).filter(d => d < span[0] || d > span[1]).length;
  const bar = document.createElement("i");
  bar.style.background = `linear-gradient(90deg, ${STOPS.map(stop => `rgb(${stop})`).join(",")})`;
  const square = rgb => Object.assign(document.createElement("b"), { textContent: " \u25a0", style: `color: rgb(${rgb})` });
  const floor = ground ? [square(FLOOR), " floor", square(DROP), " below it"] : [];
  place.replaceChildren(far, bar, near, beyond ? ` ${beyond} ends beyond these colours` : "", ...floor);
}

/// Grey pixels as a picture half as bright, so that colours stand out. Of a dark one all but the
/// brightest hundredth is stretched to white first.
export function dimmed(grey, width, height) {
  const white = Uint8Array.from(grey).sort()[Math.floor(0.99 * (grey.length - 1))], gain = 0.62 * (white < 128 ? 255 / Math.max(white, 8) : 1);
  const rgba = new Uint8ClampedArray(4 * width * height).fill(255), canvas = document.createElement("canvas");
  grey.forEach((value, i) => rgba.fill(value * gain, 4 * i, 4 * i + 3));
  Object.assign(canvas, { width, height }).getContext("2d").putImageData(new ImageData(rgba, width, height), 0, 0);
  return canvas;
}

/// A picture, or black, with squares of `side` px around points, segments, outlines of bars, and
/// boxes with their numbers. With a `ground` the floor and what lies below it have colours of their
/// own.
export function drawPair(canvas, { width, height, picture, ground }, { points, side, segments, bars = [], boxes, span }) {
  const scale = Math.max(1, Math.round(1280 / width)), context = canvas.getContext("2d"), size = Math.max(8, width / 32);
  Object.assign(canvas, { width: width * scale, height: height * scale });
  context.imageSmoothingEnabled = false;
  context.scale(scale, scale);
  if (picture) context.drawImage(picture, 0, 0, width, height);
  for (const { x, y, disparity } of points) {
    context.fillStyle = onGround(ground, [[x, y, disparity]], disparity, span, side > 2 ? 0.3 : 0.8);
    const drawn = Math.max(side - 0.5, 1);
    context.fillRect(x + 0.5 - drawn / 2, y + 0.5 - drawn / 2, drawn, drawn);
  }
  context.lineWidth = 1.2;
  for (const { x, y, disparity } of [...segments].reverse()) {
    const ends = [0, 1].map(end => [x[end], y[end], disparity[end]]);
    context.strokeStyle = onGround(ground, ends, (disparity[0] + disparity[1]) / 2, span);
    context.beginPath();
    // Whole numbers are centres of pixels.
    context.moveTo(x[0] + 0.5, y[0] + 0.5);
    context.lineTo(x[1] + 0.5, y[1] + 0.5);
    context.stroke();
  }
  for (const { x, y, wide, disparity } of bars) {
    context.strokeStyle = colour((disparity[0] + disparity[1]) / 2, span);
    context.beginPath();
    for (const [across, end] of [[0, 0], [0, 1], [wide, 1], [wide, 0]]) context.lineTo(x[end] + across + 0.5, y[end] + 0.5);
    context.closePath();
    context.stroke();
  }
  context.strokeStyle = context.fillStyle = "#fff";
  context.font = `${size}px ${FONT}`;
  boxes.forEach(({ left, top, right, bottom }, i) => {
    context.strokeRect(left, top, right - left, bottom - top);
    context.fillText(`${i + 1}`, left + 2, top + size);
  });
}

/// A round distance between rings: 1, 2 or 5 times a power of ten, at least `far / count`.
export function ringStep(far, count) {
  const least = far / count, power = 10 ** Math.floor(Math.log10(least));
  return [1, 2, 5, 10].map(f => f * power).find(s => s >= least);
}

/// Points from above, the camera below: x to the right and z ahead in m. Sectors, where there are
/// any, as arcs at their distances, edges of drop-offs dashed.
export function drawTop(canvas, points, span, sectors = []) {
  const context = canvas.getContext("2d"), [middle, base] = [canvas.width / 2, canvas.height - 20];
  context.clearRect(0, 0, canvas.width, canvas.height);
  if (!points.length && !sectors.length) return;
  // Points seen through a window should not make the room small.
  const distances = points.map(p => p.z).sort((a, b) => a - b);
  const far = 1.2 * (distances[Math.floor(0.93 * (distances.length - 1))] ?? Math.max(...sectors.map(sector => sector.distance)));
  const half = far * points.reduce((most, { x, z }) => Math.max(most, Math.abs(x / z)), 0.25);
  const scale = Math.min(canvas.width / (2 * half), (canvas.height - 30) / far), at = (x, z) => [middle + x * scale, base - z * scale];
  context.strokeStyle = context.fillStyle = "#888";
  context.font = `13px ${FONT}`;
  const step = ringStep(far, 4);
  for (let z = step; z < far; z += step) {
    const [x, y] = at(0, z);
    context.beginPath();
    context.arc(middle, base, z * scale, Math.PI, 2 * Math.PI);
    context.stroke();
    context.fillText(`${+z.toPrecision(3)} m`, x + 4, y - 3);
  }
  for (const { x, z, disparity } of points) {
    context.fillStyle = colour(disparity, span, 0.5);
    const [u, v] = at(x, z);
    context.fillRect(u - 1, v - 1, 2, 2);
  }
  context.strokeStyle = "#d0339a"; // of no point
  context.lineWidth = 3;
  for (const { from, to, distance, isEdge } of sectors) {
    context.setLineDash(isEdge ? [4, 4] : []);
    context.beginPath();
    context.arc(middle, base, distance * scale, from - Math.PI / 2, to - Math.PI / 2);
    context.stroke();
  }
  context.setLineDash([]);
  context.lineWidth = 1;
}

/// Has `drawn` called with each box that the visitor draws, by mouse or by keys, and `dragged`
/// while it is drawn, with null at its end; in px of an image of this `size()`.
export function onBoxes(canvas, size, dragged, drawn) {
  let box = null;
  const place = event => {
    const area = canvas.getBoundingClientRect(), inside = (value, most) => Math.min(most, Math.max(0, Math.round(value))), [width, height] = size();
    return [inside((event.clientX - area.left) * width / area.width, width), inside((event.clientY - area.top) * height / area.height, height)];
  };
  canvas.addEventListener("pointerdown", event => {
    if (event.button !== 0) return;
    canvas.setPointerCapture(event.pointerId);
    const [x, y] = place(event);
    box = { from: [x, y], left: x, top: y, right: x, bottom: y };
  });
  canvas.addEventListener("pointermove", event => {
    if (!box) return;
    const [x, y] = place(event), [x0, y0] = box.from;
    Object.assign(box, { left: Math.min(x, x0), top: Math.min(y, y0), right: Math.max(x, x0), bottom: Math.max(y, y0) });
    dragged(box);
  });
  canvas.addEventListener("pointerup", () => {
    const { left, top, right, bottom } = box ?? {};
    box = null;
    if (right > left && bottom > top) drawn({ left, top, right, bottom });
    dragged(null);
  });
  canvas.addEventListener("pointercancel", () => { box = null; dragged(null); });
  // Keys: arrows move a box, with Shift they size it, with Ctrl by one pixel; Enter asks for it,
  // Escape drops it.
  canvas.tabIndex = 0;
  let held = null;
  const drop = () => { held = null; dragged(null); };
  canvas.addEventListener("blur", () => { if (held) drop(); });
  canvas.addEventListener("keydown", event => {
    const by = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key], [width, height] = size();
    if (!by && !(held && ["Enter", "Escape"].includes(event.key))) return;
    event.preventDefault();
    if (!by) {
      if (event.key === "Enter") drawn({ ...held });
      return drop();
    }
    const middle = side => [Math.round(0.4 * side), Math.round(0.6 * side)], [[left, right], [top, bottom]] = [middle(width), middle(height)];
    const { ...now } = held ?? { left, top, right, bottom }, step = event.ctrlKey ? 1 : Math.max(1, Math.round(width / 40));
    const [dx, dy] = by.map(way => way * step), within = (value, least, most) => Math.min(most, Math.max(least, value));
    if (event.shiftKey) {
      Object.assign(now, { right: within(now.right + dx, now.left + 1, width), bottom: within(now.bottom + dy, now.top + 1, height) });
    } else if (held) {
      const [x, y] = [within(dx, -now.left, width - now.right), within(dy, -now.top, height - now.bottom)];
      Object.assign(now, { left: now.left + x, right: now.right + x, top: now.top + y, bottom: now.bottom + y });
    }
    dragged(held = now);
  });
}
