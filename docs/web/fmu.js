"use strict";
// The plant, an FMU: variables by name on top of the FMI 2.0 functions of the binary.

const COSIMULATION = 1, WARNING = 1; // fmi2Type, fmi2Status

/** One instance. An error of the FMU is thrown with its own message. */
class Fmu {
  /** type: from compiled() */
  constructor(type) {
    this.type = type;
    this.errors = [];
    const page = { log: (status, message) => this.#take(status, message) };
    this.wasm = instantiated(type, { page });
    const callbacks = this.wasm.page_callbacks();
    const name = placed(this.wasm, "page");
    const guid = placed(this.wasm, type.guid);
    this.component = this.wasm.fmi2Instantiate(name, COSIMULATION, guid, 0, callbacks, 0, 0);
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

  #setStart(name, value) {
    const { type, reference } = variableOf(this.type, name);
    const kind = type === "Enumeration" ? "Integer" : type; // in the names of the functions
    const references = new WasmArray(this.wasm, Uint32Array, 1);
    const values = new WasmArray(this.wasm, kind === "Real" ? Float64Array : Int32Array, 1);
    references.values[0] = reference;
    values.values[0] = value;
    this.call(`fmi2Set${kind}`, references.place, 1, values.place);
  }

  #take(status, place) {
    if (status <= WARNING) return;
    this.errors.push(textAt(this.wasm, place).replaceAll("%%", "%")); // it is a format
  }

  #explain(failed) {
    const message = this.errors.at(-1)?.replace(/^fmi2\w+: (.)/, (_, letter) => letter.toUpperCase());
    return message ?? `${this.type.name}: ${failed} failed`;
  }
}

/** Several Real outputs, that are read in one call. */
class Outputs {
  constructor(fmu, names) {
    this.fmu = fmu;
    this.array = new WasmArray(fmu.wasm, Float64Array, names.length);
    this.references = new WasmArray(fmu.wasm, Uint32Array, names.length);
    this.references.values.set(names.map((name) => variableOf(fmu.type, name).reference));
  }

  /** The values of the last call of read(). */
  get values() {
    return this.array.values;
  }

  read() {
    this.fmu.call("fmi2GetReal", this.references.place, this.array.length, this.array.place);
    return this.values;
  }
}
