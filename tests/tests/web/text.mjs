// A result as the examples for C print it. Self-contained: it is sent into the page, too.
export function text(csv, { points, health }, middle) {
  const decimals = value => Math.round(value * 1e5) / 1e5, finite = metres => (metres === Infinity ? "" : decimals(metres));
  const lines = points.map(({ x, y, disparity, confidence }) => `${x},${y},${disparity},${decimals(confidence)}`);
  const object = middle.reason ?? `${middle.disparity} +- ${middle.sigma} px,${finite(middle.depth)},${finite(middle.nearest)}`;
  const flags = `${health.names.join("+") || "good"}, ${health.is_fit ? "fit" : "not fit"}`;
  return `${csv}${["x,y,disparity_px,confidence", ...lines, `middle: ${object}`, `health: ${flags}`, ""].join("\n")}`;
}
export const middle = (width, height) => {
  const [w, h] = [Math.floor(width / 4), Math.floor(height / 4)];
  return { left: w, top: h, right: 3 * w, bottom: 3 * h };
};
