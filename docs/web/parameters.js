"use strict";
// The parameters of the estimator for a log: the fields of the page, and their values.

const ASKED = ["motor.B", "motor.D_theta", "rls.n", "range.phi", "prior.tau_e", "prior.B",
  "prior.D_theta", "prior.tau_coulomb", "noise.tau"];
const ASKED_WITH_SETTING = ["rls.m", "setPoint.offset", "setPoint.scale", "range.setPoint",
  "range.setPoint_center"];
const REQUIRED = ["setPoint.offset", "setPoint.scale"]; // no value of another robot fits
const ROOM = 1.2; // of a range over what the log has
const MEASURED = { // sizes of the signals, unless the user gives a value
  "range.phi": ({ theta, q }) => ROOM * largest(q.map((value, i) => value - theta[i])),
  "noise.tau": ({ tau }) => noise(tau),
  "prior.tau_e": ({ tau }, { "motor.gamma": gear }) => ROOM * gear * largest(tau),
  "range.setPoint": (signals, given) => (ROOM / 2) * spread(setPoints(signals, given)),
  "range.setPoint_center": (signals, given) => middle(setPoints(signals, given)),
};

const parameters = {
  set: document.getElementById("parameters"),

  /** A field for each parameter. What the user has typed stays. */
  show(hasSetting) {
    const { variables } = ESTIMATOR, before = this.typed();
    const names = [...ASKED, ...(hasSetting ? ASKED_WITH_SETTING : []), "rls.symmetric"];
    const labels = names.map((name) => {
      const { type, unit, description, start } = variables[name];
      const measured = name in MEASURED, required = REQUIRED.includes(name);
      const value = before[name] ?? (measured || required ? "" : Number(UNKNOWN[name] ?? start));
      const field = type === "Boolean" ? checkbox(name, before[name] ?? start === "true") : number(name, value);
      field.required = required;
      if (measured) field.placeholder = "from the log";
      const shown = unit && unit !== "1" ? ` [${unit.replaceAll(".", "·").replace(/2\b/, "²")}]` : "";
      return Object.assign(labelled(`${name}${shown}`, field), { title: description });
    });
    this.set.replaceChildren(this.set.querySelector("legend"), ...labels);
  },

  /** Forgets what the user has typed. */
  clear() {
    for (const label of this.set.querySelectorAll("label")) label.remove();
  },

  /** Parameters that have a value. */
  typed() {
    const values = {};
    for (const field of this.set.querySelectorAll("input"))
      if (field.type === "checkbox") values[field.name] = field.checked;
      else if (field.value.trim() !== "") values[field.name] = Number(field.value);
    return values;
  },

  /** All values for the signals of a log; gear: its ratio. */
  values(signals, gear) {
    const given = { ...this.typed(), "motor.gamma": gear };
    const names = Object.keys(MEASURED).filter((name) => signals.theta_c || !name.startsWith("range.setPoint"));
    const measured = names.map((name) => [name, MEASURED[name](signals, given)]);
    return { "rls.m": 1, ...Object.fromEntries(measured), ...given };
  },

  /** A message of the estimator, and what to do where it names a value that the user has not typed. */
  withAdvice(message) {
    if (/samplePeriod/.test(message)) return `${message} Is the unit of the time right?`;
    const typed = this.typed();
    const measured = Object.keys(MEASURED).find((name) => message.startsWith(`${name}: `) && !(name in typed));
    return measured ? `${message}. It comes from the log: look at the units and the gear ratio, or fill it in.` : message;
  },
};

function setPoints({ theta_c }, { "setPoint.offset": offset, "setPoint.scale": scale }) {
  return theta_c.map((position) => offset + scale * position);
}
