"use strict";
// Numbers and doubts as people read them, numbers with the minus sign of print.

/** A number as people read it: never a hundred digits. */
function shortly(value) {
  const size = Math.abs(value), plain = value === 0 || (size >= 1e-3 && size < 1e5);
  const text = plain ? value.toFixed(size < 10 ? 2 : 1) : Number(value.toPrecision(3)).toExponential();
  return printed(text);
}

/** With three digits, as 0.0123. */
function threeDigits(value) {
  return printed(String(Number(value.toPrecision(3))));
}

/** A value and the half of its band: three digits of the band, and the value as far as the band. */
function withBand(value, half) {
  const size = Math.max(Math.abs(value), half);
  if (!(half > 0 && size < Infinity)) return shortly(value);
  const power = size >= 1e5 || size < 1e-3 ? Math.floor(Math.log10(size)) : 0, unit = 10 ** power;
  const decimals = 2 - Math.floor(Math.log10(Number((half / unit).toPrecision(3))));
  const [a, b] = [value, half].map((each) => (each / unit).toFixed(Math.min(Math.max(decimals, 0), 9)));
  return printed(power ? `(${a} ± ${b})e${power}` : `${a} ± ${b}`);
}

function printed(text) {
  return text.replaceAll("-", "−").replace("e+", "e");
}

const DOUBT = ESTIMATOR.variables.doubt.items, NO_DOUBT = DOUBT.None;

/** In words, of a value of the output doubt. */
function confidence(doubt) {
  return doubt === NO_DOUBT ? "confident" : `not confident: ${reason(doubt)}`;
}

/** The name of a value of the output doubt, as everywhere. */
function reason(doubt) {
  return Object.keys(DOUBT).find((name) => DOUBT[name] === doubt);
}
