"use strict";
// What the output doubt of the estimator means, in words.

const DOUBT = FMUS.StiffnessEstimator.variables.doubt.items, NO_DOUBT = DOUBT.None;
const DOUBTS = {
  NoClaim: "the method claims no band",
  NotExcited: "too little motion yet",
  Misfit: "the data contradict the model",
  OutOfRange: "deformation beyond range.phi",
  FrictionOutsidePrior: "friction far from what was given",
  InertiaOutsidePrior: "inertia far from what was given",
  NegativeStiffness: "stiffness below 0",
  Change: "the stiffness changes",
};

/** In words, of a value of the output doubt. */
function confidence(doubt) {
  return doubt === NO_DOUBT ? "confident" : `not confident: ${reason(doubt)}`;
}

function reason(doubt) {
  return DOUBTS[Object.keys(DOUBT).find((name) => DOUBT[name] === doubt)];
}
