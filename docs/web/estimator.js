"use strict";
// The estimator, the C library: variables by name on top of harness/native/joints.h. INPUTS and POINT
// are the names that the Python package has for the arguments of sh_joints_run, and for sh_point.

const MOST_TICKS = 200; // of one call
const VIOLATION = { size: 24, value: 8, range: 16 }; // of sh_violation [bytes]

class Estimator {
  /**
   * type: from compiled(); parameters: numbers by name; record: names of the outputs of run()
   *
   * Throws an error for a parameter that is out of its range.
   */
  constructor(type, parameters, record) {
    this.type = type;
    this.wasm = instantiated(type);
    this.joint = this.wasm.malloc(this.wasm.sh_joint_size());
    const { samplePeriod = variableOf(type, "samplePeriod").start } = parameters;
    this.wasm.sh_joint_default(this.joint, Number(samplePeriod)); // which other start values follow
    for (const [name, value] of Object.entries(parameters)) this.#set(name, value);
    this.#check();
    this.wasm.sh_joint_start(this.joint);
    this.inputs = INPUTS.map(() => new WasmArray(this.wasm, Float64Array, MOST_TICKS));
    this.record = record;
    this.outputs = record.map((name) => this.#output(name));
    this.outputPlaces = new WasmArray(this.wasm, Uint32Array, 2 * record.length); // sh_joint_output
    this.outputPlaces.values.set(
      record.flatMap((name, i) => [variableOf(type, name).reference, this.outputs[i].place]));
  }

  /**
   * A tick for each sample, at most MOST_TICKS.
   *
   * signals: arrays of equal size by name; a signal that is not there is 0
   *
   * Returns the recorded outputs by name, until the next call.
   */
  run(signals) {
    const count = signals.theta.length;
    const places = INPUTS.map((name, i) => {
      if (!signals[name]) return 0;
      this.inputs[i].values.set(signals[name]);
      return this.inputs[i].place;
    });
    const { place } = this.outputPlaces;
    this.wasm.sh_joints_run(this.joint, 1, 0, count, 0, count, ...places, place, this.record.length);
    return Object.fromEntries(
      this.record.map((name, i) => [name, this.outputs[i].values.subarray(0, count)]));
  }

  /**
   * Torque and stiffness by the present estimate, which does not change; see
   * sh_estimator_evaluate.
   *
   * phi: deformations [rad]; setPoint: one for all
   *
   * Returns an array of each member of sh_point: tau_e and tau_e_std [N.m], sigma and sigma_std
   * [N.m/rad], sigma_per_gain [1].
   */
  evaluate(phi, setPoint) {
    const count = phi.length;
    const [deformations, setPoints] = [1, 2].map(() => new WasmArray(this.wasm, Float64Array, count));
    const points = new WasmArray(this.wasm, Float64Array, POINT.length * count);
    deformations.values.set(phi);
    setPoints.values.fill(setPoint);
    this.wasm.sh_joint_evaluate(this.joint, count, deformations.place, setPoints.place, points.place);
    const { values } = points;
    return Object.fromEntries(POINT.map(
      (name, i) => [name, Float64Array.from(phi, (_, k) => values[POINT.length * k + i])]));
  }

  #output(name) {
    const Type = variableOf(this.type, name).type === "Real" ? Float64Array : Int32Array;
    return new WasmArray(this.wasm, Type, MOST_TICKS);
  }

  #set(name, value) {
    const { type, reference } = variableOf(this.type, name);
    if (type !== "Real" && !Number.isInteger(Number(value)))
      throw new Error(`${name}: expected a whole number, got ${value}`);
    this.wasm.sh_joint_set(this.joint, reference, value);
  }

  #check() {
    const place = this.wasm.malloc(VIOLATION.size);
    if (!this.wasm.sh_joint_check(this.joint, place)) return;
    const view = new DataView(this.wasm.memory.buffer, place);
    const name = textAt(this.wasm, view.getUint32(0, true));
    const range = textAt(this.wasm, view.getUint32(VIOLATION.range, true));
    const value = view.getFloat64(VIOLATION.value, true);
    throw new Error(`${name}: expected ${range}, got ${Number(value.toPrecision(9))}`);
  }
}
