"use strict";
// What the user says about the columns of a log: a field for each choice, all of them required.

const choices = {
  form: document.getElementById("log"),
  signals: document.getElementById("signals"),

  /** Empty fields for the columns of another log. */
  show(columns) {
    this.form.elements["gear ratio"].value = "";
    this.signals.replaceChildren(...Object.entries(SIGNALS).map(([name, signal]) => {
      const set = document.createElement("fieldset"), legend = document.createElement("legend");
      legend.textContent = signal.title;
      set.append(legend, ...this.fields(name, signal, columns));
      return set;
    }));
    parameters.clear();
    this.showWhatIsNeeded();
  },

  /** Fields of a signal with their labels; "theta unit" is the name of the field for the unit of theta. */
  fields(name, { units, optional, side, direction }, columns) {
    const symbols = Object.keys(units);
    const none = optional ? [[NO_COLUMN, "none"]] : [];
    const listed = [...none, ...columns.filter(Boolean).map((column) => [column, column])];
    const labels = [
      labelled("column", list(`${name} column`, listed)),
      labelled("unit", list(`${name} unit`, symbols.map((unit) => [unit, unit.replaceAll(".", "·")]))),
    ];
    if (symbols.some((unit) => units[unit].per)) labels.push(labelled("", required(number(`${name} per`, ""))));
    if (symbols.includes("counts")) labels.push(labelled("the counter starts again", list(`${name} counter`, COUNTERS)));
    if (side) labels.push(labelled(side, list(`${name} side`, SIDES)));
    if (direction) labels.push(labelled(direction, list(`${name} direction`, DIRECTIONS)));
    if (name !== "time") labels.push(labelled("value at zero", required(number(`${name} zero`, 0))));
    return labels;
  },

  /** Hides the fields that the choices so far do not need, and says what is missing. */
  showWhatIsNeeded() {
    for (const [name, { units }] of Object.entries(SIGNALS)) {
      const { column, unit } = this.of(name), per = units[unit]?.per;
      const isNeeded = (what) => {
        if (what === "column") return true;
        if (column === NO_COLUMN) return false;
        if (what === "per") return per !== undefined;
        return what !== "counter" || unit === "counts";
      };
      for (const field of this.signals.querySelectorAll(`[name^="${name} "]`)) {
        const label = field.closest("label"), [, what] = field.name.split(" ");
        field.disabled = label.hidden = !isNeeded(what);
        if (what === "per") label.firstChild.textContent = per ?? "";
      }
    }
    const { column } = this.of("theta_c");
    parameters.show(column !== "" && column !== NO_COLUMN);
    this.showMissing();
  },

  /** Required fields without a value. */
  missing() {
    return [...this.form.elements].filter((field) => field.willValidate && field.validity.valueMissing);
  },

  showMissing() {
    const wordsByName = new Map();
    for (const field of this.missing()) {
      const [name, what] = field.name.split(" ");
      const words = wordsByName.get(name) ?? [];
      if (what) words.push(MISSING[what] ?? (what === "per" ? field.closest("label").textContent : what));
      wordsByName.set(name, words);
    }
    const listed = [...wordsByName].map(([name, words]) => (words.length ? `${name} (${words.join(", ")})` : name));
    say("missing", listed.length ? `Still missing: ${listed.join(", ")}.` : "");
  },

  /** What is chosen for a signal; empty or NaN where nothing is. */
  of(name) {
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

  /** What is chosen for each signal that the log has. */
  all() {
    const chosen = Object.keys(SIGNALS).map((name) => [name, this.of(name)]);
    return Object.fromEntries(chosen.filter(([, { column }]) => column !== NO_COLUMN));
  },

  /** The gear ratio. Throws an error if it is not above 0. */
  gear() {
    const ratio = Number(this.form.elements["gear ratio"].value);
    if (!(ratio > 0)) throw new Error(`gear ratio: expected a number above 0, got ${ratio}`);
    return ratio;
  },
};

const MISSING = { side: "side of the gear", zero: "value at zero" }; // what is not called as in its field's name
