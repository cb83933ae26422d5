"use strict";
// Which column is which signal, by the words in its name: WORDS are those of `sigmahat init`.

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
  const words = wordsOf(column), unit = unitOf(column);
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

/** motorPos_rad: motor, pos, rad */
function wordsOf(column) {
  return parts(column.replace(/([a-z])([A-Z])/g, "$1 $2"));
}

/** The unit at the end of a name, also in brackets. */
function unitOf(column) {
  const last = parts(column).at(-1);
  return Object.keys(WORDS.unit).find((unit) => WORDS.unit[unit].includes(last));
}

function parts(column) {
  return column.toLowerCase().replace(/n\.m/g, "nm").split(/[^\p{L}\d]+/u).filter(Boolean);
}
