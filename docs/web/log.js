"use strict";
// A log of the user: the file, its signals by what the user has chosen, and the estimate.

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
      this.form.addEventListener(name, () => { this.forget(); choices.showMissing(); });
    choices.signals.addEventListener("change", () => choices.showWhatIsNeeded());
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
    choices.show(this.table.names);
  },

  /** The signals of the log in rad and N.m, and its sample period [s]. */
  read() {
    const gear = choices.gear(), chosen = choices.all();
    checkColumns(chosen);
    const { time, ...signals } = Object.fromEntries(Object.entries(chosen).map(
      ([name, choice]) => [name, converted(this.table.column(choice.column), name, choice, gear)]));
    checkMotion(signals);
    return { signals, T: samplePeriod(time, this.table.first) };
  },

  starts({ signals, T }) {
    const gear = choices.gear();
    return {
      ...parameters.values(signals, gear),
      samplePeriod: T,
      method: METHODS.FilteredRegression,
      modality: SCENARIO.estimator.modality,
      "encoder.theta": resolution("theta", choices.of("theta"), gear),
      "encoder.q": resolution("q", choices.of("q"), gear),
    };
  },

  /** Estimates, or puts the cursor into the first field that is missing. */
  async estimate() {
    this.forget();
    const [missing] = choices.missing();
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
