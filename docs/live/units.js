"use strict";
// Units of columns, and their conversion to the unit of the port: sign (x - zero) factor / gear.

const TURN = 2 * Math.PI;
// A unit with `per` needs another number: one of the column is that number, or a turn has so many.
const ANGLES = {
  rad: { factor: 1 },
  deg: { factor: TURN / 360 },
  mrad: { factor: 1e-3 },
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
const PORTS = {
  time: { title: "time", units: TIMES },
  theta: { title: "theta: motor", units: ANGLES, geared: true },
  q: { title: "q: link", units: ANGLES },
  tau: { title: "tau: torque of the motor", units: TORQUES },
  theta_c: {
    title: "theta_c: motor that sets the stiffness",
    units: { ...ANGLES, mm: { factor: 1 } },
    optional: true,
  },
};

/** Values of a column in the unit of its port. */
function converted(values, port, { unit, per, gear, zero, reversed }) {
  const { factor, per: what } = PORTS[port].units[unit];
  if (what && !(per > 0)) throw new Error(`${port}: expected a number above 0 for ${what}, got ${per}`);
  if (PORTS[port].geared && !(gear > 0)) throw new Error(`${port}: expected a gear ratio above 0, got ${gear}`);
  if (port !== "time" && !Number.isFinite(zero)) throw new Error(`${port}: expected a number as zero, got ${zero}`);
  const scale = ((reversed ? -1 : 1) * (what ? factor(per) : factor)) / (gear || 1);
  const steady = unit === "counts" ? unwrapped(values) : values;
  return steady.map((value) => (value - (zero || 0)) * scale);
}

/** A counter that starts again, after a power of two, goes on instead. */
function unwrapped(values) {
  const [low, high] = range(values), period = 2 ** Math.ceil(Math.log2(high - low + 1));
  let turns = 0;
  return values.map((value, i) => {
    const jump = i ? value - values[i - 1] : 0;
    if (Math.abs(jump) > 0.9 * period) turns -= Math.sign(jump);
    return value + turns * period;
  });
}
