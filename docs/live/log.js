"use strict";
// A log of the user: the file, its columns, the parameters, and the answer.

const ASKED = ["motor.B", "motor.D_theta", GEAR, "rls.n", "range.phi", "prior.tau_e", "prior.B",
  "prior.D_theta", "prior.tau_coulomb", "noise.tau"];
const ASKED_WITH_SETTING = ["rls.m", "setPoint.offset", "setPoint.scale", "range.setPoint",
  "range.setPoint_center"];

const log = {
  form: document.getElementById("log"),

  open() {
    const drop = document.getElementById("drop"), file = document.getElementById("file");
    answer.open();
    file.addEventListener("change", () => { this.take(file.files[0]); file.value = ""; });
    for (const name of ["dragenter", "dragover", "dragleave", "drop"])
      document.addEventListener(name, (event) => {
        event.preventDefault(); // beside the field, a browser would open the file instead of the page
        drop.classList.toggle("over", name === "dragenter" || name === "dragover");
        if (name === "drop") this.take(event.dataTransfer.files[0]);
      });
    this.form.addEventListener("submit", (event) => { event.preventDefault(); this.estimate(); });
    for (const name of ["input", "change"]) this.form.addEventListener(name, () => this.forget());
    this.form.addEventListener("change", (event) => { if (event.target.closest("#ports")) this.showParameters(); });
  },

  /** Ends a run and hides its answer, which would be one to other settings. */
  forget() {
    this.run = null;
    document.getElementById("progress").hidden = true;
    document.getElementById("result").hidden = true;
    say("log-message", "");
  },

  async take(file) {
    if (!file) return;
    this.form.hidden = true;
    this.forget();
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
    document.querySelectorAll("#parameters label").forEach((label) => label.remove()); // of another log
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
    checkMotion(signals);
    return { signals, T: samplePeriod(time, this.table.first) };
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
    const names = [...ASKED, ...(this.chosen("theta_c").column ? ASKED_WITH_SETTING : []), "rls.symmetric"];
    const before = this.typed();
    const fields = names.map((name) => {
      const { type, unit, description, start } = variables[name], label = document.createElement("label");
      label.title = description;
      const asks = name in GUESSES || name === GEAR;
      const field = type === "Boolean" ? checkbox(name, before[name] ?? start === "true")
        : number(name, before[name] ?? (asks ? "" : Number(UNKNOWN[name] ?? start)));
      if (asks) field.placeholder = name === GEAR ? "fill in" : "from the log";
      label.append(`${name}${unit && unit !== "1" ? ` [${unit.replaceAll(".", "·").replace(/2\b/, "²")}]` : ""}`, field);
      return label;
    });
    set.replaceChildren(set.querySelector("legend"), ...fields);
  },

  /** Parameters that have a value. */
  typed() {
    const values = {};
    for (const field of document.querySelectorAll("#parameters input"))
      if (field.type === "checkbox") values[field.name] = field.checked;
      else if (field.value.trim() !== "") values[field.name] = Number(field.value);
    return values;
  },

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
      method: METHODS.FilteredRegression,
      modality: SCENARIO.estimator.modality,
      "encoder.theta": counts("theta"),
      "encoder.q": counts("q"),
    };
  },

  async estimate() {
    const bar = document.getElementById("progress");
    this.forget();
    let run = null;
    try {
      const data = this.read();
      this.run = run = new LogEstimate(joint.estimator, this.starts(data), data.signals);
      bar.hidden = false;
      await run.run((done) => { bar.value = done; }, () => this.run !== run);
      if (this.run === run) answer.show(run);
    } catch (error) {
      if (this.run === run) say("log-message", withAdvice(error.message, this.typed()));
    }
    if (this.run === run) bar.hidden = true; // another one may run by now
  },
};

// Inputs, each with its name for those who hear the page.

function chooser(name, values, chosen) {
  const made = named("select", name);
  made.append(...values.map((value) => new Option(value || "none", value, false, value === chosen)));
  return made;
}

function number(name, value) {
  return Object.assign(named("input", name), { type: "number", step: "any", value });
}

function checkbox(name, checked = false) {
  return Object.assign(named("input", name), { type: "checkbox", checked });
}

function named(tag, name) {
  const made = document.createElement(tag);
  made.name = name;
  made.setAttribute("aria-label", name);
  return made;
}

log.open();
