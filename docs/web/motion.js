"use strict";
// What the signals of a log must show, and how large they are.

const ROUNDING = 1e-12; // of a sum of positions, over the largest

/** Throws an error for signals that tell nothing of a stiffness. */
function checkMotion({ theta, q, tau }) {
  const phi = q.map((value, i) => value - theta[i]), size = Math.max(largest(theta), largest(q));
  if (largest(phi) <= ROUNDING * size) throw new Error("theta and q do not differ: choose another column for one of them");
  if (spread(phi) <= ROUNDING * size) throw new Error(
    `theta and q: expected a deformation that changes, got ${threeDigits(phi[0])} rad in all rows`);
  if (spread(tau) === 0) throw new Error(
    `tau: expected a torque that changes, got ${threeDigits(tau[0])} N·m in all rows`);
}

/** Time between samples, of times in s that rise evenly, the first of them in row `first`. A rounded time may be off by half of it. */
function samplePeriod(times, first) {
  const T = (times.at(-1) - times[0]) / (times.length - 1);
  if (!(T > 0)) throw new Error(`time: expected times that rise, got ${times[0]} s first and ${times.at(-1)} s last`);
  for (let i = 1; i < times.length; i += 1) {
    const step = times[i] - times[i - 1];
    if (!(Math.abs(step - T) <= T / 2)) throw new Error(
      `time: expected steps of about ${Number(T.toPrecision(3))} s as in the mean, got ${Number(step.toPrecision(3))} s `
      + `in row ${i + first}; the command sigmahat estimate takes logs with gaps`);
  }
  return Number(T.toPrecision(9));
}

/**
 * Standard deviation of the noise of a signal: of its second differences, in which a motion hardly
 * shows. Their median counts, since friction steps.
 */
function noise(values) {
  const seconds = values.slice(2).map((value, i) => Math.abs(value - 2 * values[i + 1] + values[i])).sort();
  return (1.4826 * seconds[seconds.length >> 1]) / Math.sqrt(6) || 1e-6 * largest(values);
}

function largest(values) {
  return values.reduce((most, value) => Math.max(most, Math.abs(value)), 0);
}

function spread(values) {
  const [low, high] = extremes(values);
  return high - low;
}

function middle(values) {
  const [low, high] = extremes(values);
  return (low + high) / 2;
}

function extremes(values) {
  const low = values.reduce((least, value) => Math.min(least, value), Infinity);
  const high = values.reduce((most, value) => Math.max(most, value), -Infinity);
  return [low, high];
}
