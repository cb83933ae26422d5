"use strict";
// A CSV file as columns of numbers. What is wrong with it is said in one line, with the row.

const MOST_BYTES = 100e6, FEWEST_COLUMNS = 4; // time, theta, q, tau

class Table {
  constructor(text) {
    this.lines = text.replace(/^\uFEFF|[\r\n]+$/g, "").split(/\r\n|\n|\r/);
    this.separator = [";", "\t"].find((each) => this.lines[0].includes(each)) ?? ",";
    this.names = this.#cells(0);
    this.rows = this.lines.length - 1;
    const numbers = this.rows ? this.#cells(1).filter((cell) => Number.isFinite(this.#number(cell))) : [];
    if (numbers.length < FEWEST_COLUMNS) throw new Error(
      `expected a line of names, and numbers in at least ${FEWEST_COLUMNS} columns below it, got `
      + `"${this.lines[0].slice(0, 60)}" and "${this.lines[1]?.slice(0, 60) ?? ""}"`);
    const twice = this.names.find((name, i) => this.names.indexOf(name) !== i);
    if (twice !== undefined) throw new Error(`expected a name of its own for each column, got "${twice}" twice`);
  }

  /** The column of this name. Throws an error that names the first row without a finite number. */
  column(name) {
    const place = this.names.indexOf(name), { length } = this.names;
    return Float64Array.from({ length: this.rows }, (_, i) => {
      const cells = this.#cells(i + 1), value = this.#number(cells[place]);
      if (cells.length !== length) throw new Error(
        `row ${i + 2}: expected ${length} cells, one for each name, got ${cells.length}`);
      if (!Number.isFinite(value)) throw new Error(
        `row ${i + 2}, column ${name}: expected a finite number, got "${cells[place].slice(0, 40)}"`);
      return value;
    });
  }

  #cells(i) {
    const line = this.lines[i];
    if (!line.includes('"')) return line.split(this.separator).map((cell) => cell.trim());
    const cells = [""];
    let quoted = false; // a separator inside quotes belongs to the cell
    for (const part of line.split(/([",;\t])/)) {
      if (part === '"') quoted = !quoted;
      else if (part === this.separator && !quoted) cells.push("");
      else cells[cells.length - 1] += part;
    }
    return cells.map((cell) => cell.trim());
  }

  /** With a separator that is no comma, a comma is a decimal sign: 1,5 for 1.5. */
  #number(text) {
    return text ? Number(this.separator === "," ? text : text.replace(",", ".")) : NaN;
  }
}

/** Time between samples, of times in s that rise evenly. A rounded time may be off by half of it. */
function samplePeriod(times) {
  const T = (times.at(-1) - times[0]) / (times.length - 1);
  if (!(T > 0)) throw new Error(`time: expected times that rise, got ${times[0]} s first and ${times.at(-1)} s last`);
  for (let i = 1; i < times.length; i += 1) {
    const step = times[i] - times[i - 1];
    if (!(Math.abs(step - T) <= T / 2)) throw new Error(
      `time: expected steps of about ${Number(T.toPrecision(3))} s as in the mean, got ${Number(step.toPrecision(3))} s `
      + `in row ${i + 2}; the command sigmahat estimate takes logs with gaps`);
  }
  return Number(T.toPrecision(9));
}
