"use strict";
// What the columns of a log mean. The user chooses all of it; the page guesses nothing.

const TURN = 2 * Math.PI;
// A unit with `per` needs another number: one of the column is that number, or a turn has so many.
const ANGLES = {
  rad: { factor: 1 },
  deg: { factor: TURN / 360 },
  mrad: { factor: 1e-3 },
  arcmin: { factor: TURN / 21600 },
  arcsec: { factor: TURN / 1296000 },
  turn: { factor: TURN },
  counts: { per: "counts per turn", factor: (number) => TURN / number },
};
const TORQUES = {
  "N.m": { factor: 1 },
  "mN.m": { factor: 1e-3 },
  "N.cm": { factor: 1e-2 },
  "kN.m": { factor: 1e3 },
  A: { per: "N·m per A", factor: (number) => number },
  mA: { per: "N·m per A", factor: (number) => number / 1000 },
};
const TIMES = { s: { factor: 1 }, ms: { factor: 1e-3 }, us: { factor: 1e-6 }, ns: { factor: 1e-9 } };

// `geared`: the side of the gear on which the column is the signal times the gear ratio.
const SIGNALS = {
  time: { title: "time", units: TIMES },
  theta: {
    title: "theta: position of the motor",
    units: ANGLES,
    side: "encoder: side of the gear",
    geared: "motor",
    direction: "positive direction",
  },
  q: { title: "q: position of the link", units: ANGLES },
  tau: {
    title: "tau: torque of the motor",
    units: TORQUES,
    side: "measured: side of the gear",
    geared: "joint",
    direction: "positive direction",
  },
  theta_c: {
    title: "theta_c: setting of the stiffness",
    units: { ...ANGLES, mm: { factor: 1 } },
    optional: true,
  },
};
const NO_COLUMN = " none"; // no name of a column, as these begin with no space
// Items of lists: [value, what is shown].
const SIDES = [["motor", "motor's side"], ["joint", "joint's side"]];
const DIRECTIONS = [["same", "as q"], ["opposite", "opposite to q"]];
const BITS = [8, 10, 12, 14, 16, 18, 20, 24, 32]; // of counters
const COUNTERS = [["never", "never"], ...BITS.map((bits) => [bits, `after ${2 ** bits}`])];

/**
 * The values of a column as a signal: zero at `zero`, in rad, N.m or s; theta and q at the joint,
 * tau at the motor.
 *
 * choice: { unit, per, counter, side, direction, zero }; gear: turns of the motor per turn of the joint
 */
function converted(values, name, { unit, per, counter, side, direction, zero }, gear) {
  const { factor, per: what } = SIGNALS[name].units[unit];
  if (what && !(per > 0)) throw new Error(`${name}: expected a number above 0 for ${what}, got ${per}`);
  const steady = unit === "counts" && counter !== "never" ? unwrapped(values, 2 ** counter) : values;
  const ratio = isGeared(name, side) ? gear : 1;
  const sign = direction === "opposite" ? -1 : 1;
  const scale = (sign * (what ? factor(per) : factor)) / ratio;
  return steady.map((value) => (value - zero) * scale);
}

/** Counts of a position per turn of the joint; 0 if it is not in counts. */
function resolution(name, { unit, per, side }, gear) {
  if (unit !== "counts") return 0;
  return isGeared(name, side) ? per * gear : per;
}

function isGeared(name, side) {
  return SIGNALS[name].geared === side;
}

/** A counter that starts again after a number of counts goes on instead. */
function unwrapped(values, period) {
  let periods = 0;
  return values.map((value, i) => {
    if (i) periods -= Math.round((value - values[i - 1]) / period);
    return value + periods * period;
  });
}

/** Throws an error for a column that is chosen for two signals. chosen: { column } by signal */
function checkColumns(chosen) {
  const signals = new Map();
  for (const [name, { column }] of Object.entries(chosen)) {
    if (signals.has(column)) throw new Error(
      `${signals.get(column)} and ${name} have the same column, ${column}: choose another one for one of them`);
    signals.set(column, name);
  }
}
