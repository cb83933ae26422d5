"use strict";
// The simulated joint: settings, the run in frames of the browser, values and plots.

const SECONDS = SCENARIO.duration; // shown
const NORMAL_95 = 1.96; // half the width of an interval of 95 % over the standard deviation
const SHOWN = {
  plant: ["sigma", "tau_e"],
  estimator: ["sigma", "tau_e", "sigma_std", "doubt"],
};
// Of the noise of the paper: the estimator is told no less, since it has to be told some.
const LEAST_NOISE = 1 / 20;
const MOST_WORK = 8; // [ms] of a frame, for samples: at a speed that is too high, time goes slower

const joint = {
  form: document.getElementById("settings"),
  running: false,

  async open() {
    [this.plant, this.estimator] = await Promise.all([PLANT, ESTIMATOR].map(compiled));
    this.plots = ["stiffness", "torque"].map((id) => new Plot(id));
    const { items } = this.estimator.variables.method;
    this.form.elements.method.append(
      ...Object.entries(items).reverse().map(([name, value]) => new Option(name, value)));
    this.form.addEventListener("submit", (event) => event.preventDefault());
    this.form.addEventListener("input", (event) => {
      if (event.target.name !== "speed") this.start();
    });
    document.getElementById("run").addEventListener("click", () => this.run(!this.running));
    document.getElementById("again").addEventListener("click", () => {
      this.start();
      this.run(true);
    });
    requestAnimationFrame((now) => this.frame(now));
    this.start();
    this.run(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  },

  setting(name) {
    return Number(this.form.elements[name].value);
  },

  start() {
    try {
      this.simulation = new Simulation(this.plant, this.estimator, this.starts(), SHOWN);
      say("joint-message", "");
    } catch (error) {
      this.simulation = null;
      say("joint-message", error.message);
    }
    this.due = 0;
    const names = ["t", "sigma", "tau_e", "sigma_hat", "tau_e_hat", "half"];
    this.history = new Samples(names, Math.round(SECONDS / SCENARIO.T) + 1);
    this.showSettings();
    this.advance(1, Infinity);
    this.show();
  },

  run(running) {
    this.running = running;
    document.getElementById("run").textContent = running ? "Pause" : "Start";
  },

  starts() {
    const { variables } = this.estimator, of = this.plant.variables, noise = this.setting("noise");
    const believed = 1 + this.setting("friction") / 100;
    return {
      plant: {
        ...SCENARIO.plant,
        "signal.tau.frequency": this.setting("frequency"),
        "motor.tau_coulomb": this.setting("coulomb") / 1000,
        "noise.tau_variance": Number(of["noise.tau_variance"].start) * noise ** 2,
      },
      estimator: {
        ...SCENARIO.estimator,
        method: this.setting("method"),
        "motor.D_theta": Number(of["motor.D_theta"].start) * believed,
        "noise.tau": Number(variables["noise.tau"].start) * Math.max(noise, LEAST_NOISE),
      },
    };
  },

  /** A frame of the browser, at a time in ms. */
  frame(now) {
    requestAnimationFrame((next) => this.frame(next));
    const passed = Math.min(now - (this.last ?? now), 100);
    this.last = now;
    if (!this.running || !this.simulation) return;
    this.due += (this.setting("speed") * passed) / 1000 / SCENARIO.T;
    this.due -= this.advance(Math.floor(this.due), MOST_WORK);
    this.due = Math.min(this.due, 1000);
    this.show();
  },

  /** Makes samples, for at most so many ms. Returns how many. */
  advance(samples, most) {
    const begin = performance.now();
    let made = 0;
    try {
      while (this.simulation && made < samples && performance.now() - begin < most) {
        const t = this.simulation.time;
        const { plant, estimator: [estimate, torque, std, doubt] } = this.simulation.advance();
        const claims = this.simulation.start.estimator.method === METHODS.FilteredRegression;
        this.history.push(t, ...plant, estimate, torque, claims ? NORMAL_95 * std : NaN);
        this.doubt = doubt;
        made += 1;
      }
    } catch (error) {
      this.simulation = null;
      say("joint-message", error.message);
    }
    return made;
  },

  showSettings() {
    const show = (name, text) => { this.form.elements[`${name}-shown`].value = text; };
    const friction = this.setting("friction");
    show("frequency", `${this.setting("frequency")} Hz`);
    show("friction", `${friction > 0 ? "+" : ""}${friction} %`.replace("-", "−"));
    show("coulomb", `${this.setting("coulomb")} mN·m`);
    show("noise", `${this.setting("noise")} × that of the paper`);
  },

  show() {
    if (!this.simulation) return;
    const { history } = this, [t, half] = ["t", "half"].map((name) => history.get(name));
    const now = t.at(-1), x = [Math.max(0, now - SECONDS), Math.max(SECONDS, now)];
    const [stiffness, torque] = ["sigma", "tau_e"].map((name) => [
      { x: t, y: history.get(name), color: "true" },
      { x: t, y: history.get(`${name}_hat`), color: "estimate" },
    ]);
    stiffness[1].half = half;
    const [least, most] = reaching(...stiffness);
    const y = [least < 0 ? roomy([least, most])[0] : 0, roomy([0, 1.3 * most])[1]];
    this.plots[0].draw({ x, y, curves: stiffness });
    this.plots[1].draw({ x, y: roomy(reaching(...torque)), curves: torque });
    const [truth, estimate] = stiffness.map((curve) => curve.y.at(-1));
    say("value-t", `${now.toFixed(2)} s`);
    say("value-true", `${truth.toFixed(1)} N·m/rad`);
    say("value-sigma", `${withBand(estimate, half.at(-1))} N·m/rad`);
    say("value-error", `${shortly((100 * (estimate - truth)) / truth)} %`);
    say("value-doubt", confidence(this.doubt));
  },
};

const METHODS = ESTIMATOR.variables.method.items;

function say(id, text) {
  document.getElementById(id).textContent = text;
}

const opened = joint.open().catch((error) => {
  say("joint-message", `This browser cannot run the page: ${error.message}`);
  throw error;
});
