"use strict";
// Parameters of the estimator that come from the log.

const ROOM = 1.2; // of a range over what the log has
const GEAR = "motor.gamma"; // the log does not show it, and no value of another robot fits
const GUESSES = { // parameters with a value that comes from the log; others begin as in the FMU
  "range.phi": ({ theta, q }) => ROOM * largest(q.map((value, i) => value - theta[i])),
  "noise.tau": ({ tau }) => noise(tau),
  "prior.tau_e": ({ tau }, { [GEAR]: gamma }) => ROOM * Math.abs(gamma) * largest(tau),
};

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
