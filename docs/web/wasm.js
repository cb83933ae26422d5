"use strict";
// What the two binaries have in common: how they are compiled and started, and arrays and text in
// their memory.

/** Compiles a binary of compiled.js. Resolves to the same description with its module. */
async function compiled(described) {
  const text = atob(described.wasm);
  const bytes = Uint8Array.from(text, (character) => character.charCodeAt(0));
  return { ...described, module: await WebAssembly.compile(bytes) };
}

/** The functions of a new instance. */
function instantiated({ module }, imports = {}) {
  const functions = new WebAssembly.Instance(module, imports).exports;
  functions._initialize();
  return functions;
}

/** An array in the memory of an instance, for as long as the instance exists. */
class WasmArray {
  /** Type: Float64Array, Int32Array or Uint32Array */
  constructor(wasm, Type, length) {
    this.wasm = wasm;
    this.Type = Type;
    this.length = length;
    this.place = wasm.malloc(length * Type.BYTES_PER_ELEMENT);
  }

  /** All values; not to be kept, because the memory moves when it grows. */
  get values() {
    const { buffer } = this.wasm.memory;
    if (this.view?.buffer !== buffer) this.view = new this.Type(buffer, this.place, this.length);
    return this.view;
  }
}

/** The text at a place in the memory, up to its 0. */
function textAt(wasm, place) {
  const bytes = new Uint8Array(wasm.memory.buffer, place);
  return new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
}

/** Writes a text into the memory. Returns its place. */
function placed(wasm, text) {
  const bytes = new TextEncoder().encode(`${text}\0`);
  const place = wasm.malloc(bytes.length);
  new Uint8Array(wasm.memory.buffer, place).set(bytes);
  return place;
}

/** Description of a variable of the plant or the estimator. */
function variableOf(described, name) {
  const variable = described.variables[name];
  if (!variable) throw new Error(`${described.name} has no variable ${name}`);
  return variable;
}
