"use strict";
// The co-simulation master: at every sample the outputs of the plant go into the estimator, which
// makes its tick; then the plant, which makes its torques itself, goes on to the next sample.

class Simulation {
  /**
   * plant, estimator: from compiled(); start values of each by name, in { plant, estimator }
   * record: { plant, estimator }, names of Real outputs to read at each sample
   */
  constructor(plant, estimator, start, record) {
    this.start = start;
    this.k = 0;
    this.plant = new Fmu(plant);
    this.estimator = new Fmu(estimator);
    this.plant.initialize(start.plant);
    this.estimator.initialize(start.estimator);
    this.sent = new Signals(this.plant, Object.values(SCENARIO.connections));
    this.received = new Signals(this.estimator, Object.keys(SCENARIO.connections));
    this.recorded = {
      plant: new Signals(this.plant, record.plant),
      estimator: new Signals(this.estimator, record.estimator),
    };
    this.doubt = new Signals(this.estimator, ["doubt"]);
  }

  /** Time of the next sample [s]. */
  get time() {
    return SCENARIO.T * this.k;
  }

  /** One sample. What was recorded of it is in `recorded`, until the next one. */
  advance() {
    const T = SCENARIO.T, t = this.time;
    this.recorded.plant.get();
    this.received.set(this.sent.get());
    this.estimator.step(t, T);
    this.recorded.estimator.get();
    this.doubt.get();
    this.plant.step(t, T);
    this.k += 1;
  }
}
