"use strict";
// Fields of forms.

/** A list in which nothing is chosen at first. items: [value, what is shown] of each */
function list(name, items) {
  const made = named("select", name);
  made.append(new Option("choose", ""), ...items.map(([value, text]) => new Option(text, value)));
  return required(made);
}

function number(name, value) {
  return Object.assign(named("input", name), { type: "number", step: "any", value });
}

function checkbox(name, checked) {
  return Object.assign(named("input", name), { type: "checkbox", checked });
}

function required(field) {
  return Object.assign(field, { required: true });
}

/** A field below its text. */
function labelled(text, field) {
  const label = document.createElement("label");
  label.append(Object.assign(document.createElement("span"), { textContent: text }), field);
  return label;
}

function named(tag, name) {
  return Object.assign(document.createElement(tag), { name });
}
