"use strict";
// The answer of the estimator to a log: in words, over time, and over the deformation.

const COLORS = ["estimate", "second", "third"]; // of the set-points

const answer = {
  open() {
    this.plots = ["log-stiffness", "curve-stiffness", "curve-torque"].map((id) => new Plot(id));
  },

  /** Of a LogEstimate that has run. */
  show(run) {
    const { sigma, sigma_std: std } = run.columns;
    const curves = run.curves();
    const t = sigma.map((_, k) => k * run.T);
    document.getElementById("result").hidden = false;
    say("answer", inWords(run, curves));
    document.getElementById("answer").scrollIntoView({ block: "nearest" });
    const drawn = (x, y, deviations, color) => ({ x, y, half: deviations.map((each) => NORMAL_95 * each), color });
    const stiffness = curves.map((curve, i) => drawn(curve.phi, curve.sigma, curve.sigma_std, COLORS[i]));
    const torque = curves.map((curve, i) => drawn(curve.phi, curve.tau_e, curve.tau_e_std, COLORS[i]));
    const [overTime, ...overDeformation] = this.plots, several = curves.length > 1 ? curves : [];
    overTime.draw({ x: range(t), y: reach(stiffness, sigma), curves: [drawn(t, sigma, std, "estimate")] });
    overDeformation.forEach((plot, place) => {
      const shown = [stiffness, torque][place];
      plot.draw({ x: range(...shown.map(({ x }) => x)), y: roomy(range(...shown.flatMap(ends))), curves: shown });
      plot.keys.replaceChildren(...several.map(({ setPoint }, i) => key(COLORS[i], `set-point ${shortly(setPoint)}`)));
    });
  },
};

/** For the stiffness over time: that of the curves, and that of the second half of the log, if it is not far off. */
function reach(curves, sigma) {
  const [lowest, highest] = range(...curves.flatMap(ends)), [low, high] = range(sigma.subarray(sigma.length >> 1));
  const far = 3 * Math.max(Math.abs(lowest), Math.abs(highest));
  const least = Math.min(0, lowest, Math.max(low, -far)), most = Math.max(0, highest, Math.min(high, far));
  const [bottom, top] = roomy([1.3 * least, 1.3 * most]);
  return [least < 0 ? bottom : 0, most > 0 ? top : 0];
}

function inWords(run, curves) {
  const values = curves.map(({ phi, sigma, sigma_std: std, setPoint }) => {
    const i = phi.reduce((best, value, k) => (Math.abs(value) < Math.abs(phi[best]) ? k : best), 0); // next to 0
    const where = curves.length > 1 ? ` at set-point ${shortly(setPoint)}` : "";
    return `${withBand(sigma[i], NORMAL_95 * std[i])} N·m/rad at ${threeDigits(phi[i])} rad${where}`;
  });
  const { doubt, valid } = run.columns;
  const found = shares(doubt), percent = (share) => `${threeDigits(100 * share)} %`;
  const sure = found.find(([value]) => value === NO_DOUBT)?.[1] ?? 0;
  const reasons = found.filter(([value]) => value !== NO_DOUBT)
    .map(([value, share]) => `${reason(value)}: ${percent(share)}`);
  const skipped = valid.filter((each) => !each).length;
  return `Stiffness, with 95 % band: ${values.join("; ")} (${confidence(doubt.at(-1))}). In the second half of the log the `
    + `estimator was confident ${percent(sure)} of the time${reasons.length ? ` (${reasons.join(", ")})` : ""}.`
    + (skipped ? ` It skipped ${skipped} rows, whose numbers are too large.` : "");
}
