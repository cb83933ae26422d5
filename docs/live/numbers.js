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
  if (!(half > 0 && Math.max(Math.abs(value), half) < Infinity)) return shortly(value);
  const decimals = Math.min(Math.max(2 - Math.floor(Math.log10(half)), 0), 9);
  return printed(`${value.toFixed(decimals)} ± ${half.toFixed(decimals)}`);
}

function printed(text) {
  return text.replaceAll("-", "−").replace("e+", "e");
}

const DOUBT = FMUS.StiffnessEstimator.variables.doubt.items, NO_DOUBT = DOUBT.None;

/** In words, of a value of the output doubt. */
function confidence(doubt) {
  return doubt === NO_DOUBT ? "confident" : `not confident: ${reason(doubt)}`;
}

/** The name of a value of the output doubt, as everywhere. */
function reason(doubt) {
  return Object.keys(DOUBT).find((name) => DOUBT[name] === doubt);
}
