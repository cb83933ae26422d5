"use strict";
// A CSV file as columns of numbers. PapaParse splits it into cells; here is what a log must have
// besides. What is wrong with it is said in one line, with the row of the file.

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
    if (text.includes("\0")) throw new Error("expected text with separated values, got a binary file");
    const excel = /^sep=([;,\t])\s*$/im.exec(text.slice(0, 10)); // as Excel writes above the names
    const separator = excel?.[1] ?? separatorOf(text);
    const lines = text.replace(/\r\n?/g, "\n"); // PapaParse expects one kind of end in a file
    const { data, errors } = Papa.parse(lines, { delimiter: separator, newline: "\n" });
    const rows = data.map((row) => row.map((cell) => cell.trim()));
    while (rows.length && isEmpty(rows.at(-1))) rows.pop();
    let above = rows.findIndex((row, i) => !(i === 0 && excel) && !isEmpty(row) && !isComment(row));
    if (above < 0) throw new Error("expected a CSV file with numbers, the file is empty");
    const broken = errors.find(({ row }) => row >= above);
    if (broken) throw new Error(`row ${broken.row + 1}: ${broken.message}`);
    this.comma = separator !== ","; // 1,5 for 1.5
    this.names = rows[above];
    const comment = namesOfComment(rows[above - 1]);
    if (comment.length === this.names.length && this.#numbers(rows[above]) === comment.length) {
      this.names = comment; // as numpy.savetxt writes
      above -= 1;
    }
    this.first = above + 2; // row of the file with the first numbers
    this.cells = rows.slice(above + 1);
    this.rows = this.cells.length;
    this.#check();
  }

  /** The column of this name. Throws an error that names the first row without a finite number. */
  column(name) {
    const place = this.names.indexOf(name);
    return Float64Array.from(this.cells, (_, i) => {
      const text = this.#row(i)[place];
      const value = this.#number(text);
      if (!Number.isFinite(value)) throw new Error(
        `row ${i + this.first}, column ${name}: expected a finite number, got ${text ? `"${text.slice(0, 40)}"` : "nothing"}`);
      return value;
    });
  }

  #row(i) {
    const cells = this.cells[i], { length } = this.names;
    if (cells.length !== length) throw new Error(
      `row ${i + this.first}: expected ${length} cells, one for each name, got ${cells.length}`);
    return cells;
  }

  #check() {
    const { names, rows, first } = this, numeric = names.filter((name) => !Number.isNaN(this.#number(name)));
    if (names.length < FEWEST_COLUMNS) throw new Error(
      `expected at least ${FEWEST_COLUMNS} columns (time, theta, q, tau), got ${names.length}: "${shown(names)}"`);
    if (numeric.length) throw new Error(
      `expected the names of the columns above the numbers, got the number ${numeric[0]}`);
    const twice = names.find((name, i) => names.indexOf(name) !== i);
    if (twice !== undefined) throw new Error(`expected a name of its own for each column, got "${twice}" twice`);
    if (rows < FEWEST_ROWS || rows > MOST_ROWS) throw new Error(
      `expected ${FEWEST_ROWS} to ${MOST_ROWS / 1e6} million rows below the names, got ${rows}`);
    this.#row(0);
    const [numbers, below] = [0, 1].map((i) => this.#numbers(this.cells[i]));
    if (!numbers && below) throw new Error(`row ${first} has no numbers (units?): delete it`);
    if (numbers < FEWEST_COLUMNS) throw new Error(
      `expected numbers in at least ${FEWEST_COLUMNS} columns, got "${shown(this.cells[0])}" in row ${first}`);
  }

  #numbers(cells) {
    return cells.filter((cell) => Number.isFinite(this.#number(cell))).length;
  }

  #number(text) {
    return text === "" ? NaN : Number(this.comma ? text.replace(",", ".") : text);
  }
}

/** The separator in the first line that is neither empty nor a comment. */
function separatorOf(text) {
  const line = /^(?!\s*$|#).*$/m.exec(text)?.[0] ?? "";
  return [";", "\t", ","].find((separator) => line.includes(separator)) ?? ",";
}

function isEmpty(row) {
  return row.length === 1 && row[0] === "";
}

function isComment(row) {
  return row[0].startsWith("#");
}

/** The cells of a comment without its #; none of another row. */
function namesOfComment(row) {
  if (!row || !isComment(row)) return [];
  const [first, ...others] = row;
  return [first.slice(1).trim(), ...others];
}

function shown(cells) {
  return cells.join(",").slice(0, 60);
}
