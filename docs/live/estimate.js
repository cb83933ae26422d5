"use strict";
// The estimator over a log, and what it says over the deformation afterwards.

const RUN = ["sigma", "sigma_std", "phi", "setPoint"];
const FROZEN = ["sigma", "sigma_std", "tau_e", "tau_e_std"];
const INPUTS = ["theta", "q", "theta_c", "tau", "tau_e_sensor"];
const WITHIN = 41; // points of a curve
const OUTER = 0.001; // share of the points at either end: single wrong samples do not set the reach
const PIECE = 12; // [ms] of work between two looks at the events of the page

class LogEstimate {
  /** type: from compiled(); start: parameters by name; ports: arrays of equal size, in rad and N.m */
  constructor(type, start, ports) {
    this.fmu = new Fmu(type, "log");
    this.fmu.initialize(start);
    this.T = start.samplePeriod;
    this.ports = ports;
    this.rows = ports.theta.length;
    this.inputs = new Signals(this.fmu, INPUTS);
    this.outputs = new Signals(this.fmu, RUN);
    this.frozen = new Signals(this.fmu, FROZEN);
    this.doubt = new Signals(this.fmu, ["doubt"]);
    this.columns = Object.fromEntries([...RUN, "doubt"].map((name) => [name, new Float64Array(this.rows)]));
    this.k = 0;
  }

  /** All samples; tells how far it is, from 0 to 1. Stops early once `cancelled()`. */
  async run(progress, cancelled = () => false) {
    while (this.k < this.rows && !cancelled()) {
      const begin = performance.now();
      while (this.k < this.rows && performance.now() - begin < PIECE) this.#sample();
      progress(this.k / this.rows);
      await new Promise((go) => setTimeout(go));
    }
  }

  #sample() {
    const { k } = this, { theta, q, theta_c, tau } = this.ports;
    this.inputs.set([theta[k], q[k], theta_c ? theta_c[k] : 0, tau[k], 0]);
    this.fmu.step(k * this.T, this.T);
    this.outputs.get().forEach((value, i) => { this.columns[RUN[i]][k] = value; });
    [this.columns.doubt[k]] = this.doubt.get();
    this.k += 1;
  }

  /** Stiffness, torque and their standard deviations at deformations of the log, at each set-point. */
  curves() {
    return this.#settings().map(({ setPoint, thetaC, phi: [low, high] }) => {
      const phi = grid(low, high);
      const points = Array.from(phi, (each) => this.#at(each, thetaC));
      const [sigma, std, torque, torqueStd, doubt] =
        [...FROZEN, "doubt"].map((_, i) => Float64Array.from(points, (point) => point[i]));
      return { setPoint, phi, sigma, std, doubt, torque, torqueStd };
    });
  }

  /**
   * What it says at a deformation, without learning: a sample is missing before it, and after such a
   * gap FilteredRegression learns nothing until its filters have settled.
   */
  #at(phi, thetaC) {
    for (const theta of [NaN, 0]) {
      this.inputs.set([theta, phi, thetaC, 0, 0]);
      this.fmu.step(this.k * this.T, this.T);
      this.k += 1;
    }
    return [...this.frozen.get(), ...this.doubt.get()];
  }

  /** Set-points to show, three if it moves, and the deformations that the log has near each. */
  #settings() {
    const { phi, setPoint } = this.columns, thetaC = this.ports.theta_c;
    const order = Array.from(phi.keys()).sort((a, b) => setPoint[a] - setPoint[b]);
    const moves = setPoint[order.at(-1)] > setPoint[order[0]];
    const third = Math.ceil(order.length / 3);
    const parts = moves ? [0, 1, 2].map((i) => order.slice(i * third, (i + 1) * third)) : [order];
    return parts.map((part) => {
      const middle = part[Math.floor(part.length / 2)], sorted = Float64Array.from(part, (i) => phi[i]).sort();
      const cut = Math.floor(OUTER * (sorted.length - 1));
      return {
        setPoint: setPoint[middle],
        thetaC: thetaC ? thetaC[middle] : 0,
        phi: [sorted[cut], sorted[sorted.length - 1 - cut]],
      };
    });
  }
}

/** Share of each value of the output doubt in the second half of a log, the largest first. */
function shares(doubt) {
  const later = doubt.subarray(doubt.length >> 1), counts = new Map();
  for (const each of later) counts.set(each, (counts.get(each) ?? 0) + 1);
  return [...counts].sort(([, a], [, b]) => b - a).map(([value, count]) => [value, count / later.length]);
}

/** Deformations of a curve, 0 among them if it is between the ends. */
function grid(low, high) {
  const even = Array.from({ length: WITHIN }, (_, i) => low + ((high - low) * i) / (WITHIN - 1));
  return Float64Array.from(new Set(low < 0 && high > 0 ? [...even, 0] : even)).sort();
}
