// The two modules from JavaScript, in a browser and in Node: images to grey pixels, grey pixels to
// segments, points, depths and health.
//
// Structures are those of bindings/c/include/linestereo.h as a 32-bit processor lays them out.

/// Largest number of segments listed, as in the PC's program.
const SEGMENTS = 4096;
const SIZE = { config: 52, image: 20, segment: 36, point: 12 };
const OWNERS = ["left", "right", "both"];
const INFINITE = 0x7fffffff;
/// The pair is not fit to be used: its health says why.
const UNFIT = 9;
/// From here on a status says why there is no depth.
const NO_DEPTH = 100;

/// Refusal of a module, in words that say what to do.
export class Refused extends Error {}

const metres = q16 => (q16 === INFINITE ? Infinity : q16 / 65536);

/// A matcher for pairs of one size, with memory of its own.
export class Matcher {
  /// `rig`: `{ focal_px, baseline_m }` or null.
  static async make(module, { width, height, max_disparity, rig }) {
    const made = new Matcher();
    made.core = (await WebAssembly.instantiate(module)).exports;
    Object.assign(made, { width, height, rig, top: made.core.__heap_base.value });
    const config = made.take(SIZE.config);
    made.core.linestereo_config(config, width, height);
    const view = made.view();
    view.setUint16(config + 4, SEGMENTS, true);
    view.setUint16(config + 8, max_disparity, true);
    view.setFloat32(config + 28, rig ? rig.focal_px : 0, true);
    view.setFloat32(config + 32, rig ? rig.baseline_m : 0, true);
    // What is refused says why when it is made: its size is 0 then.
    const size = made.core.linestereo_scratch_size(config);
    const memory = made.take(Math.max(size, 8));
    made.results = made.take(64);
    made.check(made.core.linestereo_init(memory, size, config, made.results));
    made.matcher = made.view().getUint32(made.results, true);
    made.images = [0, 1].map(() => made.imageOf(made.take(SIZE.image), made.take(width * height)));
    made.points = made.take(SIZE.point * width * height);
    return made;
  }

  /// So many bytes for as long as the matcher lives.
  take(bytes) {
    const at = Math.ceil(this.top / 8) * 8;
    this.top = at + bytes;
    const missing = this.top - this.core.memory.buffer.byteLength;
    if (missing > 0) this.core.memory.grow(Math.ceil(missing / 65536));
    return at;
  }

  view() {
    return new DataView(this.core.memory.buffer);
  }

  imageOf(at, pixels) {
    [pixels, this.width * this.height, this.width, 0, 0].forEach((value, i) => this.view().setUint32(at + 4 * i, value, true));
    return { at, pixels };
  }

  text(at) {
    const bytes = new Uint8Array(this.core.memory.buffer, at);
    return new TextDecoder().decode(bytes.slice(0, bytes.indexOf(0)));
  }

  status(code) {
    return this.text(this.core.linestereo_status_text(code));
  }

  check(code) {
    if (code !== 0) throw new Refused(this.status(code));
  }

  /// Grey pixels of both images -> the result; `milliseconds` is the core's share.
  run(left, right) {
    for (const [i, pixels] of [left, right].entries()) {
      if (pixels.length !== this.width * this.height) throw new Refused("an image has another size than the matcher");
      new Uint8Array(this.core.memory.buffer, this.images[i].pixels, pixels.length).set(pixels);
    }
    const started = performance.now();
    const code = this.core.linestereo_run(this.matcher, this.images[0].at, this.images[1].at, 0);
    const milliseconds = performance.now() - started;
    if (code !== UNFIT) this.check(code);
    const health = this.health();
    const segments = Array.from({ length: health.matched }, (_, i) => this.segment(i));
    return { milliseconds, health, segments, points: this.pointList() };
  }

  health() {
    this.check(this.core.linestereo_health(this.matcher, this.results));
    const [view, at] = [this.view(), this.results], faults = view.getUint32(at, true), names = [];
    for (let bit = 0, name; (name = this.core.linestereo_fault_name(bit)) !== 0; bit++) {
      if (faults & (1 << bit)) names.push(this.text(name));
    }
    const [is_fit, found, matched, is_cut] = [8, 36, 38, 40].map(from => view.getUint16(at + from, true));
    return { names, is_fit: is_fit === 1, found, matched, is_cut: is_cut === 1 };
  }

  segment(index) {
    this.check(this.core.linestereo_segment(this.matcher, index, this.results));
    const [view, at] = [this.view(), this.results];
    const pair = (from, read, unit) => [read(at + from), read(at + from + read.step)].map(value => value / unit);
    const u16 = Object.assign(at => view.getUint16(at, true), { step: 2 }), i16 = Object.assign(at => view.getInt16(at, true), { step: 2 });
    const depth = from => [from, from + 4].map(from => metres(view.getInt32(at + from, true)));
    return {
      x: pair(0, u16, 32), y: pair(4, u16, 32), disparity: pair(8, i16, 64), sigma: i16(at + 12) / 64, confidence: u16(at + 14) / 65536,
      owner: OWNERS[u16(at + 16)], depth: this.rig && depth(20), depth_sigma: this.rig && depth(28),
    };
  }

  pointList() {
    const capacity = this.width * this.height;
    this.check(this.core.linestereo_point_list(this.matcher, this.points, capacity, this.results));
    const view = this.view(), count = Math.min(capacity, view.getUint32(this.results, true));
    return Array.from({ length: count }, (_, i) => {
      const at = this.points + SIZE.point * i, u16 = from => view.getUint16(at + from, true);
      return { x: u16(0), y: u16(2), disparity: view.getInt16(at + 4, true) / 64, confidence: u16(6) / 65536, segment: view.getInt32(at + 8, true) };
    });
  }

  /// The depth of what lies in a box of pixels, ends exclusive; `reason` says why there is none.
  box({ left, top, right, bottom }) {
    const view = this.view(), [area, depth] = [this.results, this.results + 8];
    [left, top, right, bottom].forEach((value, i) => view.setUint16(area + 2 * i, value, true));
    const code = this.core.linestereo_box(this.matcher, area, depth);
    if (code !== 0 && code < NO_DEPTH) this.check(code);
    const i16 = from => view.getInt16(depth + from, true) / 64, length = from => metres(view.getInt32(depth + from, true));
    return {
      reason: code === 0 ? null : this.status(code), disparity: i16(0), sigma: i16(2), confidence: view.getUint16(depth + 4, true) / 65536,
      support: view.getUint16(depth + 6, true), depth: length(8), depth_sigma: length(12), nearest: length(16),
    };
  }
}

/// Image files or pixels of a camera -> the grey images of a pair, by the PC program's own code.
export class Images {
  static async make(module) {
    const made = new Images();
    made.module = module;
    await made.forget();
    return made;
  }

  /// Drops all images, with the memory that they took.
  async forget() {
    this.code = (await WebAssembly.instantiate(this.module)).exports;
  }

  /// A decoder that panics ends its module: the image is broken.
  call(name, ...values) {
    let is_done;
    try {
      is_done = this.code[name](...values);
    } catch (error) {
      if (!(error instanceof WebAssembly.RuntimeError)) throw error;
      throw new Refused("its decoder failed; give another file");
    }
    if (!is_done) throw new Refused(this.reason());
  }

  reason() {
    const bytes = new Uint8Array(this.code.memory.buffer, this.code.reason(), this.code.reason_bytes());
    return new TextDecoder().decode(bytes);
  }

  fill(bytes) {
    const room = this.code.room(bytes.length);
    if (room === 0) throw new Refused("more than 128 MiB are not read; give a smaller image");
    new Uint8Array(this.code.memory.buffer, room, bytes.length).set(bytes);
  }

  /// Adds a PNG or PGM file.
  addFile(bytes) {
    this.fill(bytes);
    this.call("add_file");
  }

  /// Adds pixels as a canvas has them.
  addPixels(rgba, width, height) {
    this.fill(rgba);
    this.call("add_pixels", width, height);
  }

  /// The images added, as a pair: one image is both side by side, which is to be said of those that
  /// are not twice as wide as high. `width` reduces them, 0 does not: by `scale`, and so a focal
  /// length in px.
  pair(width, holdsBoth = false) {
    this.call("pair", width, holdsBoth);
    const size = { width: this.code.width(), height: this.code.height() }, bytes = size.width * size.height;
    const [left, right] = [0, 1].map(side => new Uint8Array(this.code.memory.buffer, this.code.pixels(side), bytes).slice());
    return { ...size, scale: size.width / this.code.full_width(), left, right };
  }
}

/// At most five decimals, as the PC's program writes numbers; nothing for what is infinitely far.
export const decimals = value => (Number.isFinite(value) ? Math.round(value * 1e5) / 1e5 : "");

/// As `linestereo run --csv` of the PC's program writes segments.
export function csv({ segments }) {
  const lines = segments.map(({ x, y, disparity, sigma, confidence, owner, depth, depth_sigma }, id) => {
    const ends = [x[0], y[0], x[1], y[1]], metres = depth ? [...depth, ...depth_sigma].map(decimals) : ["", "", "", ""];
    return [id, ...ends, ...disparity, sigma, decimals(confidence), owner, ...metres].join(",");
  });
  const head = "id,x0,y0,x1,y1,disparity0_px,disparity1_px,sigma_px,confidence,owner,depth0_m,depth1_m,depth0_sigma_m,depth1_sigma_m";
  return [head, ...lines, ""].join("\n");
}
