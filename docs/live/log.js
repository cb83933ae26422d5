"use strict";
// A log of the user: the file, its columns, the parameters, and the answer.

const COLORS = ["estimate", "second", "third"];
const ROOM = 1.2; // of a range over what the log has
const GEAR = "motor.gamma"; // the log does not show it, and no value of another robot fits
const GUESSES = { // parameters with a value that comes from the log; others begin as in the FMU
  "range.phi": ({ theta, q }) => ROOM * largest(q.map((value, i) => value - theta[i])),
  "noise.tau": ({ tau }) => noise(tau),
  "prior.tau_e": ({ tau }, { [GEAR]: gamma }) => ROOM * gamma * largest(tau),
};
const ASKED = ["motor.B", "motor.D_theta", GEAR, "rls.n", "range.phi", "prior.tau_e", "prior.B",
  "prior.D_theta", "prior.tau_coulomb", "noise.tau"];
const ASKED_WITH_SETTING = ["rls.m", "setPoint.offset", "setPoint.scale", "range.setPoint"];

const log = {
  form: document.getElementById("log"),

  open() {
    const drop = document.getElementById("drop"), file = document.getElementById("file");
    this.plots = ["log-stiffness", "curve-stiffness", "curve-torque"]
      .map((id) => new Plot(document.getElementById(id)));
    file.addEventListener("change", () => { this.take(file.files[0]); file.value = ""; });
    for (const name of ["dragenter", "dragover", "dragleave", "drop"])
      document.addEventListener(name, (event) => {
        event.preventDefault(); // beside the field, a browser would open the file instead of the page
        drop.classList.toggle("over", name === "dragenter" || name === "dragover");
        if (name === "drop") this.take(event.dataTransfer.files[0]);
      });
    this.form.addEventListener("submit", (event) => { event.preventDefault(); this.estimate(); });
    this.form.addEventListener("change", (event) => { if (event.target.closest("#ports")) this.showParameters(); });
  },

  /** Reads a file, and guesses its columns. */
  async take(file) {
    if (!file) return;
    this.run = null;
    this.form.hidden = document.getElementById("result").hidden = true;
    say("log-message", "");
    try {
      await opened;
      checkSize(file);
      this.table = new Table(await file.text());
    } catch (error) {
      say("log-message", `${file.name}: ${error.message}`);
      return;
    }
    say("log-name", `${file.name}: ${this.table.rows} rows`);
    this.form.hidden = false;
    this.showPorts(guessed(this.table.names));
    this.showParameters();
  },

  showPorts(found) {
    const body = document.querySelector("#ports tbody");
    body.replaceChildren(...Object.entries(PORTS).map(([port, about]) => {
      const row = document.createElement("tr"), { column, unit } = found[port] ?? {};
      const cell = (title, ...content) => {
        const made = row.insertCell();
        made.dataset.title = title;
        made.append(...content);
      };
      row.dataset.port = port;
      row.insertCell().textContent = about.title + (about.optional ? " (if there is one)" : "");
      cell("column", chooser(`${port} column`, ["", ...this.table.names], column ?? ""));
      cell("unit", chooser(`${port} unit`, Object.keys(about.units), unit));
      cell("per unit", ...(Object.values(about.units).some((each) => each.per) ? [number(`${port} per`, "")] : []));
      cell("gear ratio", ...(about.geared ? [number(`${port} gear`, 1)] : []));
      cell("zero", ...(port === "time" ? [] : [number(`${port} zero`, 0)]));
      cell("reversed", ...(port === "time" ? [] : [checkbox(`${port} reversed`)]));
      return row;
    }));
  },

  /** What is chosen for a port. */
  chosen(port) {
    const field = (name) => this.form.elements[`${port} ${name}`];
    const figure = (name) => (field(name)?.value.trim() ? Number(field(name).value) : NaN);
    return {
      column: field("column").value,
      unit: field("unit").value,
      per: figure("per"),
      gear: PORTS[port].geared ? figure("gear") : 1,
      zero: figure("zero"),
      reversed: field("reversed")?.checked ?? false,
    };
  },

  /** The signals of the log in the units of the ports, and its sample period [s]. */
  read() {
    const ports = {};
    for (const [port, { optional }] of Object.entries(PORTS)) {
      const chosen = this.chosen(port);
      if (chosen.column) ports[port] = converted(this.table.column(chosen.column), port, chosen);
      else if (!optional) throw new Error(`${port}: choose its column`);
    }
    const { time, ...signals } = ports;
    return { signals, T: samplePeriod(time) };
  },

  /** A field for each parameter. What the user has typed stays. */
  showParameters() {
    for (const port of Object.keys(PORTS)) {
      const { unit } = this.chosen(port), field = this.form.elements[`${port} per`];
      if (!field) continue;
      const { per } = PORTS[port].units[unit];
      field.closest("td").classList.toggle("unused", !per);
      field.placeholder = field.title = per ?? "";
    }
    const { variables } = joint.estimator, set = document.getElementById("parameters");
    const names = [...ASKED, ...(this.chosen("theta_c").column ? ASKED_WITH_SETTING : [])];
    const before = this.typed();
    const fields = names.map((name) => {
      const { unit, description, start } = variables[name], label = document.createElement("label");
      label.title = description;
      const asks = name in GUESSES || name === GEAR;
      const field = number(name, before[name] ?? (asks ? "" : Number(UNKNOWN[name] ?? start)));
      if (asks) field.placeholder = name === GEAR ? "fill in" : "from the log";
      label.append(`${name}${unit && unit !== "1" ? ` [${unit.replaceAll(".", "·").replace(/2\b/, "²")}]` : ""}`, field);
      return label;
    });
    const symmetric = document.createElement("label"), box = checkbox("rls.symmetric");
    symmetric.title = variables["rls.symmetric"].description;
    box.checked = before["rls.symmetric"] ?? true;
    symmetric.append("rls.symmetric", box);
    set.replaceChildren(set.querySelector("legend"), ...fields, symmetric);
  },

  /** Parameters that have a value. */
  typed() {
    const values = {};
    for (const field of document.querySelectorAll("#parameters input"))
      if (field.type === "checkbox") values[field.name] = field.checked;
      else if (field.value.trim() !== "") values[field.name] = Number(field.value);
    return values;
  },

  /** Start values of the estimator. */
  starts({ signals, T }) {
    const values = { ...this.typed() }, { gear } = this.chosen("theta");
    if (gear !== 1) values[GEAR] ??= gear;
    if (values[GEAR] === undefined) throw new Error(
      `${GEAR}: fill in the gear ratio of your joint, between motor and flexibility`);
    for (const [name, guess] of Object.entries(GUESSES)) values[name] ??= guess(signals, values);
    const counts = (port) => {
      const { unit, per, gear } = this.chosen(port);
      return unit === "counts" ? per * gear : 0; // 0: not quantised
    };
    return {
      "rls.m": 1,
      ...values,
      samplePeriod: T,
      method: METHODS.MatchedFilter,
      modality: SCENARIO.estimator.modality,
      "encoder.theta": counts("theta"),
      "encoder.q": counts("q"),
    };
  },

  /** Runs the estimator over the log, and shows its answer. */
  async estimate() {
    const bar = document.getElementById("progress");
    say("log-message", "");
    document.getElementById("result").hidden = true;
    try {
      const data = this.read();
      const run = new LogEstimate(joint.estimator, this.starts(data), data.signals);
      this.run = run;
      bar.hidden = false;
      await run.run((done) => { bar.value = done; }, () => this.run !== run);
      if (this.run === run) this.show(run);
    } catch (error) {
      say("log-message", error.message);
    }
    bar.hidden = true;
  },

  show(run) {
    const { sigma, sigma_std: std } = run.columns, warning = run.fmu.warnings[0];
    const curves = run.curves(); // for which samples have to be missing: warnings that are no news
    const t = sigma.map((_, k) => k * run.T);
    document.getElementById("result").hidden = false;
    say("answer", answer(run, curves, warning));
    document.getElementById("answer").scrollIntoView({ block: "nearest" });
    const half = std.map((each) => NORMAL_95 * each);
    const most = Math.max(...curves.flatMap((curve) => [...curve.sigma].map((each, i) => each + NORMAL_95 * curve.std[i])));
    this.plots[0].draw({
      x: range(t),
      y: [0, roomy([0, 1.3 * Math.max(most, 1e-9)])[1]],
      bands: [band(t, sigma, half)],
      lines: [{ x: t, y: sigma, color: "estimate" }],
    });
    this.showCurve(this.plots[1], curves, ({ sigma: y, std: s }) => [y, s]);
    this.showCurve(this.plots[2], curves, ({ torque: y, torqueStd: s }) => [y, s]);
    for (const keys of document.querySelectorAll(".keys"))
      keys.replaceChildren(...(curves.length > 1 ? curves : []).map(({ setPoint }, i) => {
        const key = document.createElement("span");
        key.className = `key ${COLORS[i]}`;
        key.textContent = `set-point ${shortly(setPoint)}`;
        return key;
      }));
  },

  showCurve(plot, curves, of) {
    const all = curves.map((curve) => {
      const [y, std] = of(curve);
      return { x: curve.phi, y, half: std.map((each) => NORMAL_95 * each) };
    });
    const bands = all.map(({ x, y, half }) => band(x, y, half));
    plot.draw({
      x: range(...all.map(({ x }) => x)),
      y: roomy(range(...bands.flatMap(({ low, high }) => [low, high]))),
      bands,
      lines: all.map(({ x, y }, i) => ({ x, y, color: COLORS[i] })),
    });
  },
};

function band(x, y, half) {
  return { x, low: y.map((each, i) => each - half[i]), high: y.map((each, i) => each + half[i]), color: "band" };
}

/** The answer in words. */
function answer(run, curves, warning) {
  const { confident, doubt } = run.columns, { items } = joint.estimator.variables.doubt;
  const reason = Object.keys(items).find((name) => items[name] === doubt.at(-1));
  const values = curves.map(({ phi, sigma, std, setPoint }) => {
    const i = phi.reduce((best, each, k) => (Math.abs(each) < Math.abs(phi[best]) ? k : best), 0);
    const where = curves.length > 1 ? ` at set-point ${shortly(setPoint)}` : "";
    return `${shortly(sigma[i])} ± ${shortly(NORMAL_95 * std[i])} N·m/rad at ${Number(phi[i].toPrecision(2))} rad${where}`;
  });
  const sure = confident.at(-1) ? "The estimator is confident." : `The estimator is not confident: ${DOUBTS[reason]}.`;
  return `Stiffness, with 95 % band: ${values.join("; ")}. ${sure}${warning ? ` ${warning}` : ""}`;
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

function chooser(name, values, chosen) {
  const made = named("select", name);
  made.append(...values.map((value) => new Option(value || "none", value, false, value === chosen)));
  return made;
}

function number(name, value) {
  return Object.assign(named("input", name), { type: "number", step: "any", value });
}

function checkbox(name) {
  return Object.assign(named("input", name), { type: "checkbox" });
}

function named(tag, name) {
  const made = document.createElement(tag);
  made.name = name;
  made.setAttribute("aria-label", name);
  return made;
}

log.open();
