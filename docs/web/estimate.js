"use strict";
// The estimator over a log, and what it says over the deformation afterwards.

const RECORD = ["sigma", "sigma_std", "phi", "setPoint", "doubt", "valid"];
const WITHIN = 41; // points of a curve
const OUTER = 0.001; // share of the points at either end: single wrong samples do not set the reach
const PIECE = 12; // [ms] of work between two looks at the events of the page

class LogEstimate {
  /** type: from compiled(); start: parameters by name; signals: arrays of equal size, in rad and N.m */
  constructor(type, start, signals) {
    this.estimator = new Estimator(type, start, RECORD);
    this.T = start.samplePeriod;
    this.signals = signals;
    this.rows = signals.theta.length;
    this.columns = Object.fromEntries(RECORD.map((name) => [name, new Float64Array(this.rows)]));
    this.k = 0;
  }

  /** All samples; tells how far it is, from 0 to 1. Stops early once `cancelled()`. */
  async run(progress, cancelled = () => false) {
    while (this.k < this.rows && !cancelled()) {
      const begin = performance.now();
      while (this.k < this.rows && performance.now() - begin < PIECE) this.#runSome();
      progress(this.k / this.rows);
      await new Promise((go) => setTimeout(go));
    }
  }

  #runSome() {
    const end = Math.min(this.k + MOST_TICKS, this.rows);
    const entries = Object.entries(this.signals);
    const part = Object.fromEntries(entries.map(([name, values]) => [name, values.subarray(this.k, end)]));
    const outputs = this.estimator.run(part);
    for (const name of RECORD) this.columns[name].set(outputs[name], this.k);
    this.k = end;
  }

  /** Stiffness, torque and their standard deviations at deformations of the log, at each set-point. */
  curves() {
    return this.#settings().map(({ setPoint, phi: [low, high] }) => {
      const phi = grid(low, high);
      return { setPoint, phi, ...this.estimator.evaluate(phi, setPoint) };
    });
  }

  /** Set-points to show, three if it moves, and the deformations that the log has near each. */
  #settings() {
    const { phi, setPoint } = this.columns;
    const order = Array.from(phi.keys()).sort((a, b) => setPoint[a] - setPoint[b]);
    const moves = setPoint[order.at(-1)] > setPoint[order[0]];
    const third = Math.ceil(order.length / 3);
    const parts = moves ? [0, 1, 2].map((i) => order.slice(i * third, (i + 1) * third)) : [order];
    return parts.map((part) => {
      const middle = part[Math.floor(part.length / 2)], sorted = Float64Array.from(part, (i) => phi[i]).sort();
      const cut = Math.floor(OUTER * (sorted.length - 1));
      return { setPoint: setPoint[middle], phi: [sorted[cut], sorted[sorted.length - 1 - cut]] };
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
