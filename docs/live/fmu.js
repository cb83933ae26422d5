"use strict";
// One FMU as WebAssembly: variables by name on top of the FMI 2.0 functions of the binary.

const COSIMULATION = 1, WARNING = 1; // fmi2Type, fmi2Status

/** Compiles an FMU of FMUS; resolves to what `new Fmu` needs. */
async function compiled(name) {
  const text = atob(FMUS[name].wasm);
  const bytes = Uint8Array.from(text, (character) => character.charCodeAt(0));
  return { ...FMUS[name], module: await WebAssembly.compile(bytes) };
}

/** One instance. An error of the FMU is thrown with its own message. */
class Fmu {
  constructor(type, name = "page") {
    this.type = type;
    this.errors = [];
    this.warnings = [];
    const page = { log: (status, message) => this.#take(status, message) };
    this.wasm = new WebAssembly.Instance(type.module, { page }).exports;
    this.wasm._initialize();
    const callbacks = this.wasm.page_callbacks();
    const [instance, guid] = [this.#text(name), this.#text(type.guid)];
    this.component =
      this.wasm.fmi2Instantiate(instance, COSIMULATION, guid, 0, callbacks, 0, 0);
    if (!this.component) throw new Error(this.#explain("fmi2Instantiate"));
  }

  /** Sets start values by name, and initialises at time 0. */
  initialize(start) {
    this.call("fmi2SetupExperiment", 0, 0, 0, 0, 0);
    for (const [name, value] of Object.entries(start)) this.#setStart(name, value);
    this.call("fmi2EnterInitializationMode");
    this.call("fmi2ExitInitializationMode");
  }

  /** A step from time t over h [s]. */
  step(t, h) {
    this.call("fmi2DoStep", t, h, 1);
  }

  call(name, ...values) {
    if (this.wasm[name](this.component, ...values) > WARNING) throw new Error(this.#explain(name));
  }

  variable(name) {
    const found = this.type.variables[name];
    if (!found) throw new Error(`${this.type.name} has no variable ${name}`);
    return found;
  }

  #setStart(name, value) {
    if (this.variable(name).type !== "Real" && !Number.isInteger(Number(value)))
      throw new Error(`${name}: expected a whole number, got ${value}`);
    new Signals(this, [name]).set([value]);
  }

  #text(text) {
    const bytes = new TextEncoder().encode(`${text}\0`), place = this.wasm.malloc(bytes.length);
    new Uint8Array(this.wasm.memory.buffer, place).set(bytes);
    return place;
  }

  #take(status, place) {
    const bytes = new Uint8Array(this.wasm.memory.buffer, place);
    const message = new TextDecoder().decode(bytes.subarray(0, bytes.indexOf(0)));
    const list = status > WARNING ? this.errors : this.warnings;
    if (list.length < 100) list.push(message.replaceAll("%%", "%")); // it is a format
  }

  #explain(failed) {
    const message = this.errors.at(-1)?.replace(/^fmi2\w+: (.)/, (_, letter) => letter.toUpperCase());
    return message ?? `${this.type.name}: ${failed} failed`;
  }
}

/** Several variables of one type, that are set or read in one call. */
class Signals {
  constructor(fmu, variables) {
    this.fmu = fmu;
    const { type } = fmu.variable(variables[0]);
    this.type = type === "Enumeration" ? "Integer" : type; // in the names of the functions
    this.count = variables.length;
    this.references = fmu.wasm.malloc(4 * this.count);
    this.place = fmu.wasm.malloc(8 * this.count);
    new Uint32Array(fmu.wasm.memory.buffer, this.references, this.count)
      .set(variables.map((name) => fmu.variable(name).reference));
  }

  /** The values of the last call, in the memory of the FMU. */
  get values() {
    const buffer = this.fmu.wasm.memory.buffer; // a new one when the memory grows
    if (this.view?.buffer !== buffer) {
      const List = this.type === "Real" ? Float64Array : Int32Array;
      this.view = new List(buffer, this.place, this.count);
    }
    return this.view;
  }

  get() {
    this.fmu.call(`fmi2Get${this.type}`, this.references, this.count, this.place);
    return this.values;
  }

  set(values) {
    this.values.set(values);
    this.fmu.call(`fmi2Set${this.type}`, this.references, this.count, this.place);
  }
}
