// On stdin JSON: { module } of tests/wasm-kernels. Prints what it says: kernels that differ, and
// those of the control.
import { readFileSync } from "node:fs";
const { module } = JSON.parse(readFileSync(0, "utf8"));
const { instance: { exports: kernels } } = await WebAssembly.instantiate(readFileSync(module));
console.log(JSON.stringify({ vectors: kernels.has_vectors() === 1, count: kernels.count(), differing: [0, 1].map(wrong => kernels.differing(wrong)) }));
