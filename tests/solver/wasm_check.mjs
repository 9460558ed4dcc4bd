// Run requests in the compiled WebAssembly module, and say what they gave and how long they took.
//
//   node wasm_check.mjs WASM REQUESTS RESULTS
//
// REQUESTS is a JSON list of calls of core/c_interface.h, each {function, arguments, results}: an
// argument is a number or an array of doubles ("NaN" is one, too), and `results` are the lengths of
// the arrays that it fills.  RESULTS becomes a list of {status, results, seconds}, with the arrays
// in base64.
import { readFileSync, writeFileSync } from "node:fs";

const [wasm, requests, results] = process.argv.slice(2);
const { instance } = await WebAssembly.instantiate(readFileSync(wasm), {});
const core = instance.exports;
core._initialize();

const put = (values) => {
  const at = core.nanowire_allocate(values.length);
  new Float64Array(core.memory.buffer, at, values.length).set(values);
  return at;
};

const answer = ({ function: name, arguments: given, results: lengths }) => {
  const passed = given.map((argument) => (Array.isArray(argument) ? put(argument) : argument));
  const filled = lengths.map((length) => core.nanowire_allocate(length));
  const started = performance.now();
  const status = core[name](...passed, ...filled);
  const seconds = (performance.now() - started) / 1000;
  // only now: memory that grows is another buffer
  const found = filled.map((at, k) =>
    Buffer.from(core.memory.buffer.slice(at, at + 8 * lengths[k])).toString("base64"),
  );
  given.forEach((argument, k) => Array.isArray(argument) && core.nanowire_free(passed[k]));
  for (const at of filled) core.nanowire_free(at);
  return { status, results: found, seconds };
};

writeFileSync(results, JSON.stringify(JSON.parse(readFileSync(requests)).map(answer)));
