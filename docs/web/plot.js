"use strict";
// A plot on a canvas: axes, lines and bands. Any number of points costs as many as there are pixels.
// And the samples that a plot shows.

const MARGIN = { left: 56, right: 10, top: 8, bottom: 26 };

const KEYS = { true: "true", estimate: "estimated", band: "95 % band" };

class Plot {
  /** id: of the canvas, which is made in the figure that is for it, below its title and its keys. */
  constructor(id) {
    const figure = document.querySelector(`[data-plot="${id}"]`), caption = document.createElement("figcaption");
    this.canvas = Object.assign(document.createElement("canvas"), { id });
    this.canvas.setAttribute("role", "img");
    this.canvas.setAttribute("aria-label", figure.getAttribute("aria-label"));
    this.keys = document.createElement("span"); // of what is drawn at times
    caption.append(figure.textContent, ...figure.dataset.keys.split(" ").map((name) => key(name, KEYS[name])), this.keys);
    figure.removeAttribute("aria-label");
    figure.replaceChildren(caption, this.canvas);
    this.pen = this.canvas.getContext("2d");
    const again = () => { if (this.content) this.draw(this.content); };
    new ResizeObserver(again).observe(this.canvas);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => {
      this.style = null;
      again();
    });
  }

  /**
   * content: x, y: ranges [low, high]; curves: [{ x, y, half, color }], arrays of equal size, x
   *          increasing; half: of a band around y, if there is one; color: a property in style.css
   */
  draw(content) {
    this.content = content;
    this.#fit();
    const { pen } = this;
    pen.clearRect(0, 0, this.width, this.height);
    this.#axes(content);
    pen.save();
    pen.beginPath();
    pen.rect(MARGIN.left, MARGIN.top, this.innerWidth, this.innerHeight);
    pen.clip();
    for (const curve of content.curves) if (curve.half) this.#band(curve);
    for (const curve of content.curves) this.#line(curve);
    pen.restore();
  }

  #fit() {
    const ratio = devicePixelRatio, { clientWidth: width, clientHeight: height } = this.canvas;
    if (this.width !== width || this.height !== height || this.ratio !== ratio) {
      Object.assign(this, { width, height, ratio });
      [this.canvas.width, this.canvas.height] = [width * ratio, height * ratio];
      this.pen.scale(ratio, ratio);
    }
    this.innerWidth = width - MARGIN.left - MARGIN.right;
    this.innerHeight = height - MARGIN.top - MARGIN.bottom;
    this.style ??= getComputedStyle(document.documentElement);
  }

  #color(name) {
    return this.style.getPropertyValue(`--${name}`);
  }

  #axes({ x, y }) {
    const { pen } = this;
    const [perX, perY] = [this.innerWidth / (x[1] - x[0]), this.innerHeight / (y[1] - y[0])];
    const [[left], [, top]] = [x, y];
    this.toX = (value) => MARGIN.left + (value - left) * perX;
    this.toY = (value) => MARGIN.top + (top - value) * perY;
    pen.font = "12px system-ui, sans-serif";
    pen.strokeStyle = this.#color("grid");
    pen.fillStyle = this.#color("soft");
    pen.lineWidth = 1;
    pen.beginPath();
    pen.textAlign = "center";
    pen.textBaseline = "top";
    for (const { value, label } of ticks(x, this.innerWidth / 80)) {
      pen.moveTo(this.toX(value), MARGIN.top);
      pen.lineTo(this.toX(value), MARGIN.top + this.innerHeight);
      pen.fillText(label, this.toX(value), this.height - MARGIN.bottom + 6);
    }
    pen.textAlign = "right";
    pen.textBaseline = "middle";
    for (const { value, label } of ticks(y, this.innerHeight / 45)) {
      pen.moveTo(MARGIN.left, this.toY(value));
      pen.lineTo(this.width - MARGIN.right, this.toY(value));
      pen.fillText(label, MARGIN.left - 6, this.toY(value));
    }
    pen.stroke();
  }

  #band(curve) {
    const [lower, upper] = ends(curve).map((end) => this.#outline(curve.x, end));
    this.pen.beginPath();
    for (const [at, , most] of upper) this.pen.lineTo(at, most);
    for (const [at, least] of lower.reverse()) this.pen.lineTo(at, least);
    this.pen.fillStyle = this.#color("band");
    this.pen.fill();
  }

  #line({ x, y, color }) {
    this.pen.beginPath();
    for (const [at, least, most] of this.#outline(x, y)) {
      this.pen.lineTo(at, least);
      if (most !== least) this.pen.lineTo(at, most);
    }
    this.pen.strokeStyle = this.#color(color);
    this.pen.lineWidth = 1.8;
    this.pen.lineJoin = "round";
    this.pen.stroke();
  }

  /** For each pixel with points: x of the first, the smallest and the largest y, on the canvas. */
  #outline(x, y) {
    const found = [], far = 10 * this.height; // a canvas draws nothing at 1e30
    for (let i = 0, pixel = null, last = null; i < x.length; i += 1) {
      const at = this.toX(x[i]), exact = this.toY(y[i]);
      if (Number.isNaN(exact)) continue;
      const value = exact > far ? far : exact < -far ? -far : exact, here = Math.floor(at);
      if (here !== pixel) {
        pixel = here;
        last = [at, value, value];
        found.push(last);
      } else if (value > last[1]) last[1] = value; // downwards on the canvas
      else if (value < last[2]) last[2] = value;
    }
    return found;
  }
}

/** The last samples of several signals, each in one piece of memory. */
class Samples {
  /** names of the signals; length: most samples that are kept */
  constructor(names, length) {
    this.length = length;
    this.count = 0;
    this.columns = Object.fromEntries(names.map((name) => [name, new Float64Array(2 * length)]));
  }

  /** Adds a sample: a value for each signal, in their order. */
  push(...values) {
    const columns = Object.values(this.columns);
    if (this.count === 2 * this.length) {
      for (const column of columns) column.copyWithin(0, this.length);
      this.count = this.length;
    }
    columns.forEach((column, i) => { column[this.count] = values[i]; });
    this.count += 1;
  }

  /** The samples that are kept, oldest first. */
  get(name) {
    return this.columns[name].subarray(Math.max(0, this.count - this.length), this.count);
  }
}

/** What a colour stands for. */
function key(color, text) {
  const made = Object.assign(document.createElement("span"), { className: `key ${color}`, textContent: text });
  made.style.setProperty("--key", `var(--${color})`);
  return made;
}

/** Both ends of the band of a curve. */
function ends({ y, half }) {
  return [y.map((each, i) => each - half[i]), y.map((each, i) => each + half[i])];
}

/** About so many round numbers in a range, with their labels. */
function ticks([low, high], count) {
  const rough = (high - low) / Math.max(count, 1);
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = power * [1, 2, 5, 10].find((factor) => factor * power >= rough);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const found = [];
  for (let i = Math.ceil(low / step); i * step <= high + 1e-9 * step; i += 1) {
    const value = i * step, large = Math.abs(value) >= 1e5 || (digits > 4 && value !== 0);
    found.push({ value, label: large ? shortly(value) : value.toFixed(value ? digits : 0).replace("-", "−") });
  }
  return found;
}

/** Smallest and largest of the values that are finite, of several arrays. */
function range(...arrays) {
  let [low, high] = [Infinity, -Infinity];
  for (const array of arrays)
    for (let i = 0; i < array.length; i += 1) {
      const value = array[i];
      if (value < low && value > -Infinity) low = value;
      if (value > high && value < Infinity) high = value;
    }
  if (low > high) return [0, 1];
  return high > low ? [low, high] : [low - (Math.abs(low) || 1) / 2, high + (Math.abs(high) || 1) / 2];
}

/** The range of a truth and of most of an estimate of it, which may be far off for a while. */
function reaching({ y: truth }, { y: estimate }) {
  const [low, high] = range(truth), most = 2 * (high - low);
  const some = estimate.filter((value, i) => i % 50 === 0 && !Number.isNaN(value)).sort();
  const at = (share) => some[Math.floor(share * (some.length - 1))] ?? low;
  return [
    Math.min(low, Math.max(at(0.05), low - most)),
    Math.max(high, Math.min(at(0.95), high + most)),
  ];
}

/** A range with some room, whose ends are round: it does not change with every sample. */
function roomy([low, high]) {
  const room = 0.05 * (high - low), step = 10 ** Math.floor(Math.log10(high - low)) / 5;
  return [Math.floor((low - room) / step) * step, Math.ceil((high + room) / step) * step];
}
