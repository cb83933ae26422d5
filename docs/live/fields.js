"use strict";
// Inputs that are made for a log, each with its name for those who hear the page.

function chooser(name, values, chosen) {
  const made = named("select", name);
  made.append(...values.map((value) => new Option(value || "none", value, false, value === chosen)));
  return made;
}

function number(name, value) {
  return Object.assign(named("input", name), { type: "number", step: "any", value });
}

function checkbox(name) {
  return Object.assign(named("input", name), { type: "checkbox" });
}

function named(tag, name) {
  const made = document.createElement(tag);
  made.name = name;
  made.setAttribute("aria-label", name);
  return made;
}
