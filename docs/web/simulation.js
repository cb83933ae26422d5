"use strict";
// The co-simulation master: at every sample the outputs of the plant go into the estimator, which
// makes its tick; then the plant, which makes its torques itself, goes on to the next sample.

class Simulation {
  /**
   * plant, estimator: from compiled(); start values of each by name, in { plant, estimator }
   * record: { plant, estimator }, names of outputs to read at each sample; Real ones of the plant
   */
  constructor(plant, estimator, start, record) {
    this.start = start;
    this.k = 0;
    this.plant = new Fmu(plant);
    this.plant.initialize(start.plant);
    this.estimator = new Estimator(estimator, start.estimator, record.estimator);
    this.measured = new Outputs(this.plant, Object.values(SCENARIO.connections));
    this.recorded = new Outputs(this.plant, record.plant);
  }

  /** Time of the next sample [s]. */
  get time() {
    return SCENARIO.T * this.k;
  }

  /** One sample. Returns { plant, estimator }, the values of what is recorded, until the next one. */
  advance() {
    const inputs = Object.keys(SCENARIO.connections);
    const plant = this.recorded.read();
    const measured = this.measured.read();
    const signals = Object.fromEntries(inputs.map((name, i) => [name, [measured[i]]]));
    const outputs = this.estimator.run(signals);
    this.plant.step(this.time, SCENARIO.T);
    this.k += 1;
    return { plant, estimator: Object.values(outputs).map(([value]) => value) };
  }
}
