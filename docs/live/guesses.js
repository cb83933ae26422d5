"use strict";
// Parameters of the estimator that come from the log, and what a log must show for it.

const ROUNDING = 1e-12; // of a sum of positions, over the largest
const ROOM = 1.2; // of a range over what the log has
const GEAR = "motor.gamma"; // the log does not show it, and no value of another robot fits
const GUESSES = { // parameters with a value that comes from the log; others begin as in the FMU
  "range.phi": ({ theta, q }) => ROOM * largest(q.map((value, i) => value - theta[i])),
  "noise.tau": ({ tau }) => noise(tau),
  "prior.tau_e": ({ tau }, { [GEAR]: gamma }) => ROOM * Math.abs(gamma) * largest(tau),
};

/** Throws an error for signals that tell nothing of a stiffness. */
function checkMotion({ theta, q, tau }) {
  const phi = q.map((value, i) => value - theta[i]), size = Math.max(largest(theta), largest(q));
  if (largest(phi) <= ROUNDING * size) throw new Error("theta and q do not differ: choose another column for one of them");
  if (spread(phi) <= ROUNDING * size) throw new Error(
    `theta and q: expected a deformation that changes, got ${threeDigits(phi[0])} rad in all rows`);
  if (spread(tau) === 0) throw new Error(
    `tau: expected a torque that changes, got ${threeDigits(tau[0])} N·m in all rows`);
}

/** A message of the FMU, and what to do where it names a value that the user has not typed. */
function withAdvice(message, typed) {
  if (/samplePeriod/.test(message)) return `${message} Is the unit of the time right? `
    + "A log with steps of more than 5.7 ms needs a smaller regression.bandwidth, which the command sigmahat estimate takes.";
  const guess = Object.keys(GUESSES).find((name) => message.includes(`${name} = `) && !(name in typed));
  return guess ? `${message} It is guessed from the log: look at the units and gear ratios, or fill it in.` : message;
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
  return values.reduce((high, each) => Math.max(high, each), -Infinity) - values.reduce((low, each) => Math.min(low, each), Infinity);
}
