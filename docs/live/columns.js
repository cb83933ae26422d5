"use strict";
// Columns of a log: their units, and which column is which signal, by the words in its name: WORDS
// are those of `sigmahat init`.

// A column is converted to the unit of its port: sign (x - zero) factor / gear.
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

/** Port by port: { column, unit }; a port is missing where no name says it. */
function guessed(names) {
  const found = {};
  for (const column of names) {
    const { quantity, side, unit } = meaning(column);
    const port = portOf(quantity, side);
    if (port && !found[port]) found[port] = { column, unit: unit in PORTS[port].units ? unit : undefined };
  }
  return found;
}

function portOf(quantity, side) {
  if (quantity === "time") return "time";
  if (quantity === "position") return { motor: "theta", link: "q", setting: "theta_c" }[side];
  if ((quantity === "torque" || quantity === "current") && side !== "sensor" && side !== "link") return "tau";
  return null;
}

function meaning(column) {
  const words = parts(column.replace(/([a-z])([A-Z])/g, "$1 $2")); // motorPos_rad: motor, pos, rad
  const last = parts(column).at(-1), unit = Object.keys(WORDS.unit).find((each) => WORDS.unit[each].includes(last));
  const says = (group) => Object.keys(WORDS[group]).filter(
    (key) => WORDS[group][key].some((entry) => ` ${words.join(" ")} `.includes(` ${entry} `)));
  const side = ["sensor", "setting", "motor", "link"].find((each) => says("side").includes(each))
    ?? says("suggests")[0];
  if (says("role").length) return {}; // what was asked for, or computed
  const quantities = says("quantity");
  const order = ["other", "acceleration", "velocity", "time", "current", "torque", "position", "index"];
  const quantity = order.find((each) => quantities.includes(each)) ?? QUANTITY_OF[unit];
  return { quantity, side, unit };
}

const QUANTITY_OF = { rad: "position", deg: "position", counts: "position", "N.m": "torque", A: "current", s: "time" };

function parts(column) {
  return column.toLowerCase().replace(/n\.m/g, "nm").split(/[^\p{L}\d]+/u).filter(Boolean);
}
