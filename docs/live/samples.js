"use strict";
// The last samples of several signals, each in one piece of memory.

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
