"use strict";
// A log of the user: the file, the meaning of its columns, and the answer.

const MISSING = { side: "side of the gear", zero: "value at zero" }; // other fields are called by their names

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
    for (const name of ["input", "change"])
      this.form.addEventListener(name, () => { this.forget(); this.showMissing(); });
    document.getElementById("signals").addEventListener("change", () => this.showWhatIsNeeded());
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
    parameters.clear(); // they were for another log
    this.showSignals();
    this.showWhatIsNeeded();
  },

  /** The choices for each signal, none of them made. */
  showSignals() {
    this.form.elements["gear ratio"].value = "";
    const sets = Object.entries(SIGNALS).map(([name, signal]) => {
      const set = document.createElement("fieldset"), legend = document.createElement("legend");
      const add = (what, text, field) => {
        const label = labelled(text, field);
        label.dataset.what = what;
        set.append(label);
      };
      const units = Object.keys(signal.units);
      const columns = this.table.names.filter(Boolean).map((column) => [column, column]);
      const none = signal.optional ? { [NO_COLUMN]: "none" } : {};
      legend.textContent = signal.title;
      set.append(legend);
      add("column", "column", list(`${name} column`, { ...none, ...Object.fromEntries(columns) }));
      add("unit", "unit", list(`${name} unit`, Object.fromEntries(units.map((unit) => [unit, unit.replaceAll(".", "·")]))));
      if (units.some((unit) => signal.units[unit].per))
        add("per", "", Object.assign(number(`${name} per`, ""), { required: true }));
      if (units.includes("counts")) add("counter", "the counter starts again", list(`${name} counter`, COUNTERS));
      if (signal.side) add("side", signal.side, list(`${name} side`, SIDES));
      if (signal.direction) add("direction", signal.direction, list(`${name} direction`, DIRECTIONS));
      if (name !== "time") add("zero", "value at zero", Object.assign(number(`${name} zero`, 0), { required: true }));
      return set;
    });
    document.getElementById("signals").replaceChildren(...sets);
  },

  /** Hides the fields that the choices so far do not need. */
  showWhatIsNeeded() {
    for (const [name, signal] of Object.entries(SIGNALS)) {
      const { column, unit } = this.choice(name);
      const per = signal.units[unit]?.per;
      const needed = { column: true, per: Boolean(per), counter: unit === "counts" };
      for (const field of this.form.querySelectorAll(`[name^="${name} "]`)) {
        const label = field.closest("label"), { what } = label.dataset;
        field.disabled = label.hidden = what !== "column" && (column === NO_COLUMN || !(needed[what] ?? true));
        if (what === "per" && per) label.firstChild.textContent = per;
      }
    }
    const { column } = this.choice("theta_c");
    parameters.show(column !== "" && column !== NO_COLUMN);
    this.showMissing();
  },

  /** Required fields without a value. */
  missing() {
    return [...this.form.elements].filter((field) => field.willValidate && field.validity.valueMissing);
  },

  showMissing() {
    const groups = new Map();
    for (const { name } of this.missing()) {
      const [of, what] = name.split(" "); // "theta column" is the column of theta
      const words = groups.get(of) ?? [];
      if (what) words.push(what === "per" ? SIGNALS[of].units[this.choice(of).unit].per : MISSING[what] ?? what);
      groups.set(of, words);
    }
    const listed = [...groups].map(([of, words]) => (words.length ? `${of} (${words.join(", ")})` : of)).join(", ");
    say("missing", listed ? `Still missing: ${listed}.` : "");
  },

  /** What is chosen for a signal; empty or NaN where nothing is. */
  choice(name) {
    const text = (what) => this.form.elements[`${name} ${what}`]?.value ?? "";
    const figure = (what) => (text(what).trim() ? Number(text(what)) : NaN);
    return {
      column: text("column"),
      unit: text("unit"),
      per: figure("per"),
      counter: text("counter"),
      side: text("side"),
      direction: text("direction"),
      zero: name === "time" ? 0 : figure("zero"),
    };
  },

  /** The gear ratio. Throws an error if it is not above 0. */
  gear() {
    const ratio = Number(this.form.elements["gear ratio"].value);
    if (!(ratio > 0)) throw new Error(`gear ratio: expected a number above 0, got ${ratio}`);
    return ratio;
  },

  /** The signals of the log in rad and N.m, and its sample period [s]. */
  read() {
    const gear = this.gear();
    const choices = Object.fromEntries(Object.keys(SIGNALS).map((name) => [name, this.choice(name)]));
    checkColumns(choices);
    const chosen = Object.entries(choices).filter(([, { column }]) => column !== NO_COLUMN);
    const { time, ...signals } = Object.fromEntries(chosen.map(
      ([name, choice]) => [name, converted(this.table.column(choice.column), name, choice, gear)]));
    checkMotion(signals);
    return { signals, T: samplePeriod(time, this.table.first) };
  },

  starts({ signals, T }) {
    const gear = this.gear();
    const counts = (name) => {
      const { unit, per, side } = this.choice(name);
      if (unit !== "counts") return 0; // not quantised
      return side === "motor" ? per * gear : per;
    };
    return {
      ...parameters.values(signals, gear),
      samplePeriod: T,
      method: METHODS.FilteredRegression,
      modality: SCENARIO.estimator.modality,
      "encoder.theta": counts("theta"),
      "encoder.q": counts("q"),
    };
  },

  /** Estimates, or puts the cursor into the first field that is missing. */
  async estimate() {
    this.forget();
    const [missing] = this.missing();
    if (missing) {
      missing.focus();
      return;
    }
    const bar = document.getElementById("progress");
    let run = null;
    try {
      const data = this.read();
      this.run = run = new LogEstimate(joint.estimator, this.starts(data), data.signals);
      bar.hidden = false;
      await run.run((done) => { bar.value = done; }, () => this.run !== run);
      if (this.run === run) answer.show(run);
    } catch (error) {
      if (this.run === run) say("log-message", parameters.withAdvice(error.message));
    }
    if (this.run === run) bar.hidden = true; // another one may run by now
  },
};

log.open();
