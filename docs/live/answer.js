"use strict";
// The answer of the estimator to a log: in words, over time, and over the deformation.

const COLORS = ["estimate", "second", "third"]; // of the set-points

const answer = {
  open() {
    this.plots = ["log-stiffness", "curve-stiffness", "curve-torque"]
      .map((id) => new Plot(document.getElementById(id)));
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
function inWords(run, curves, warning) {
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
