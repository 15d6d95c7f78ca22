// The modules in Node. On stdin JSON: { page, matcher, images, tasks: [{ files, both, width, out,
// rig }] }. Writes the grey images to out-left and out-right; with a rig prints a result for each
// task, as text. A task that is refused prints why.
import { readFileSync, writeFileSync } from "node:fs";
import { pathToFileURL } from "node:url";
import { middle, text } from "./text.mjs";

const { page, matcher, images, tasks } = JSON.parse(readFileSync(0, "utf8"));
const { Images, Matcher, Refused, csv } = await import(pathToFileURL(`${page}/linestereo.js`));
const [matching, reading] = await Promise.all([matcher, images].map(path => WebAssembly.compile(readFileSync(path))));
const done = [];
for (const { files, both = true, width, out, rig } of tasks) {
  try {
    const reader = await Images.make(reading);
    files.forEach(file => reader.addFile(readFileSync(file)));
    const pair = reader.pair(width, both);
    for (const side of ["left", "right"]) writeFileSync(`${out}-${side}`, pair[side]);
    if (!rig) {
      done.push({ size: [pair.width, pair.height] });
      continue;
    }
    const made = await Matcher.make(matching, { width: pair.width, height: pair.height, max_disparity: 64, rig });
    const result = made.run(pair.left, pair.right), found = text(csv(result), result, made.box(middle(pair.width, pair.height)));
    done.push({ text: found });
  } catch (error) {
    if (!(error instanceof Refused)) throw error;
    done.push({ refused: error.message });
  }
}
console.log(JSON.stringify(done));
