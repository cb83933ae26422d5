"use strict";
// The co-simulation master: at every sample the outputs of the plant go into the estimator, which
// makes its tick; then the plant goes on to the next sample, under torques that are linear between.

class Simulation {
  /**
   * plant, estimator: from compiled(); start values of each by name, in { plant, estimator }
   * torques: function of the number of a sample, that returns the inputs of SCENARIO in their order
   * record: { plant, estimator }, names of outputs to read at each sample
   */
  constructor(plant, estimator, start, torques, record) {
    this.start = start;
    this.torques = torques;
    this.k = 0;
    this.plant = new Fmu(plant);
    this.estimator = new Fmu(estimator);
    const inputs = Object.keys(SCENARIO.inputs);
    this.now = torques(0);
    const first = Object.fromEntries(inputs.map((name, i) => [name, this.now[i]]));
    this.plant.initialize({ ...start.plant, ...first });
    this.estimator.initialize(start.estimator);
    this.inputs = new Signals(this.plant, inputs);
    this.sent = new Signals(this.plant, Object.values(SCENARIO.connections));
    this.received = new Signals(this.estimator, Object.keys(SCENARIO.connections));
    this.recorded = {
      plant: new Outputs(this.plant, record.plant),
      estimator: new Outputs(this.estimator, record.estimator),
    };
  }

  /** Time of the next sample [s]. */
  get time() {
    return SCENARIO.T * this.k;
  }

  /** One sample. What was recorded of it is in `recorded`, until the next one. */
  advance() {
    const T = SCENARIO.T, t = this.time, { now } = this;
    this.recorded.plant.get();
    this.received.set(this.sent.get());
    this.estimator.step(t, T);
    this.recorded.estimator.get();
    this.k += 1;
    this.now = this.torques(this.k);
    this.inputs.set(now);
    this.inputs.setSlopes(this.now.map((value, i) => (value - now[i]) / (this.time - t)));
    this.plant.step(t, T);
  }
}
