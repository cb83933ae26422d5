"use strict";
// The answer of the estimator to a log: in words, over time, and over the deformation.

const COLORS = ["estimate", "second", "third"]; // of the set-points

const answer = {
  open() {
    this.plots = ["log-stiffness", "curve-stiffness", "curve-torque"].map((id) => new Plot(id));
  },

  hide() {
    document.getElementById("result").hidden = true;
  },

  /** Of a LogEstimate that has run. */
  show(run) {
    const { sigma, sigma_std: std } = run.columns, warning = run.fmu.warnings[0];
    const curves = run.curves(); // for which samples have to be missing: warnings that are no news
    const t = sigma.map((_, k) => k * run.T);
    document.getElementById("result").hidden = false;
    say("answer", inWords(run, curves, warning));
    document.getElementById("answer").scrollIntoView({ block: "nearest" });
    const half = std.map((each) => NORMAL_95 * each);
    this.plots[0].draw({
      x: range(t),
      y: reach(curves, sigma),
      bands: [band(t, sigma, half)],
      lines: [{ x: t, y: sigma, color: "estimate" }],
    });
    this.showCurve(this.plots[1], curves, ({ sigma: y, std: s }) => [y, s]);
    this.showCurve(this.plots[2], curves, ({ torque: y, torqueStd: s }) => [y, s]);
    const several = curves.length > 1 ? curves : [];
    for (const { keys } of this.plots.slice(1))
      keys.replaceChildren(...several.map(({ setPoint }, i) => key(COLORS[i], `set-point ${shortly(setPoint)}`)));
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

/** For the stiffness over time: that of the curves, and that of the second half of the log, if it is not far off. */
function reach(curves, sigma) {
  const bands = curves.map(({ sigma: y, std }) => band([], y, std.map((each) => NORMAL_95 * each)));
  const ends = range(...bands.flatMap(({ low, high }) => [low, high]));
  const far = 3 * Math.max(...ends.map(Math.abs)), [low, high] = range(sigma.subarray(sigma.length >> 1));
  const least = Math.min(0, ends[0], Math.max(low, -far)), most = Math.max(0, ends[1], Math.min(high, far));
  const [bottom, top] = roomy([1.3 * least, 1.3 * most]);
  return [least < 0 ? bottom : 0, most > 0 ? top : 0];
}

function band(x, y, half) {
  return { x, low: y.map((each, i) => each - half[i]), high: y.map((each, i) => each + half[i]), color: "band" };
}

/** The answer in words. */
function inWords(run, curves, warning) {
  const values = curves.map(({ phi, sigma, std, doubt, setPoint }) => {
    const i = nextToZero(phi);
    const where = curves.length > 1 ? ` at set-point ${shortly(setPoint)}` : "";
    return `${withBand(sigma[i], NORMAL_95 * std[i])} N·m/rad at ${threeDigits(phi[i])} rad${where} (${confidence(doubt[i])})`;
  });
  const found = shares(run.columns.doubt), percent = (share) => `${threeDigits(100 * share)} %`;
  const sure = found.find(([value]) => value === NO_DOUBT)?.[1] ?? 0;
  const reasons = found.filter(([value]) => value !== NO_DOUBT)
    .map(([value, share]) => `${reason(value)}: ${percent(share)}`);
  return `Stiffness, with 95 % band: ${values.join("; ")}. In the second half of the log the estimator was confident `
    + `${percent(sure)} of the time${reasons.length ? ` (${reasons.join(", ")})` : ""}.${warning ? ` ${warning}` : ""}`;
}
