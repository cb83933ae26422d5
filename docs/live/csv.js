"use strict";
// A CSV file as columns of numbers. What is wrong with it is said in one line, with the row.

const MOST_BYTES = 100e6, FEWEST_ROWS = 100, MOST_ROWS = 1e6;
const FEWEST_COLUMNS = 4;

/** Refuses a file before it is read. */
function checkSize({ size }) {
  if (size === 0) throw new Error("expected a CSV file with numbers, the file is empty");
  if (size > MOST_BYTES) throw new Error(
    `expected at most ${MOST_BYTES / 1e6} MB, the file has ${(size / 1e6).toFixed(0)} MB; `
    + "the command sigmahat estimate takes logs of any length");
}

class Table {
  constructor(text) {
    const lines = text.replace(/^\uFEFF/, "").split(/\r\n|\n|\r/);
    while (lines.length && lines.at(-1).trim() === "") lines.pop();
    if (text.includes("\0")) throw new Error("expected text with separated values, got a binary file");
    const told = /^sep=([;,\t])$/i.exec(lines[0]?.trimStart())?.[1]; // as Excel writes
    const isAbove = (line, i) => (i === 0 && told) || line.trim() === "" || line.startsWith("#");
    let above = lines.findIndex((line, i) => !isAbove(line, i));
    if (above < 0) throw new Error("expected a CSV file with numbers, the file is empty");
    this.separator = told ?? [";", "\t", ","].find((each) => lines[above].includes(each)) ?? ",";
    this.comma = this.separator !== ","; // 1,5 for 1.5
    this.names = this.#cells(lines[above]);
    const comment = this.#cells(lines[above - 1]?.startsWith("#") ? lines[above - 1].slice(1) : "");
    if (comment.length === this.names.length && this.#numbers(lines[above]) === comment.length) {
      this.names = comment; // as numpy.savetxt writes
      above -= 1;
    }
    this.first = above + 2; // row of the file with the first numbers
    this.lines = lines.slice(above);
    this.rows = this.lines.length - 1;
    this.#check();
  }

  /** The column of this name. Throws an error that names the first row without a finite number. */
  column(name) {
    const place = this.names.indexOf(name), values = new Float64Array(this.rows);
    for (let i = 0; i < this.rows; i += 1) {
      const text = this.#row(i)[place];
      values[i] = this.#number(text);
      if (!Number.isFinite(values[i])) throw new Error(
        `row ${i + this.first}, column ${name}: expected a finite number, got ${text ? `"${text.slice(0, 40)}"` : "nothing"}`);
    }
    return values;
  }

  #row(i) {
    const cells = this.#cells(this.lines[i + 1]), { length } = this.names;
    if (cells.length !== length) throw new Error(
      `row ${i + this.first}: expected ${length} cells, one for each name, got ${cells.length}`);
    return cells;
  }

  #check() {
    const { names, rows, first } = this, numeric = names.filter((name) => !Number.isNaN(this.#number(name)));
    if (names.length < FEWEST_COLUMNS) throw new Error(
      `expected at least ${FEWEST_COLUMNS} columns (time, theta, q, tau), got ${names.length}: "${this.lines[0].slice(0, 60)}"`);
    if (numeric.length) throw new Error(
      `expected the names of the columns above the numbers, got the number ${numeric[0]}`);
    const twice = names.find((name, i) => names.indexOf(name) !== i);
    if (twice !== undefined) throw new Error(`expected a name of its own for each column, got "${twice}" twice`);
    if (rows < FEWEST_ROWS || rows > MOST_ROWS) throw new Error(
      `expected ${FEWEST_ROWS} to ${MOST_ROWS / 1e6} million rows below the names, got ${rows}`);
    this.#row(0);
    const [numbers, below] = [1, 2].map((i) => this.#numbers(this.lines[i]));
    if (!numbers && below) throw new Error(`row ${first} has no numbers (units?): delete it`);
    if (numbers < FEWEST_COLUMNS) throw new Error(
      `expected numbers in at least ${FEWEST_COLUMNS} columns, got "${this.lines[1].slice(0, 60)}" in row ${first}`);
  }

  #numbers(line) {
    return this.#cells(line).filter((cell) => Number.isFinite(this.#number(cell))).length;
  }

  #cells(line) {
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

  #number(text) {
    return text === "" ? NaN : Number(this.comma ? text.replace(",", ".") : text);
  }
}

/** Time between samples, of times in s that rise evenly, the first of them in row `first`. A rounded time may be off by half of it. */
function samplePeriod(times, first) {
  const T = (times.at(-1) - times[0]) / (times.length - 1);
  if (!(T > 0)) throw new Error(`time: expected times that rise, got ${times[0]} s first and ${times.at(-1)} s last`);
  for (let i = 1; i < times.length; i += 1) {
    const step = times[i] - times[i - 1];
    if (!(Math.abs(step - T) <= T / 2)) throw new Error(
      `time: expected steps of about ${Number(T.toPrecision(3))} s as in the mean, got ${Number(step.toPrecision(3))} s `
      + `in row ${i + first}; the command sigmahat estimate takes logs with gaps`);
  }
  return Number(T.toPrecision(9));
}
