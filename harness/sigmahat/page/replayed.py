"""The answer of `estimate`, without its files."""

from __future__ import annotations

from collections.abc import Callable

from sigmahat.fmi.instance import Slave
from sigmahat.fmi.opened import installed
from sigmahat.logs.answer import Answer, answer
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.estimate import begin, learned_log, run
from sigmahat.logs.log import Log
from sigmahat.logs.replay import parameters
from sigmahat.logs.sampling import sample
from sigmahat.logs.statistics import ReplayStatistics


def replayed(
    log: Log, configuration: Configuration, progress: Callable[[int], object] = lambda _: None
) -> Answer:
    """Replays a log as `estimate` does, and writes nothing.

    Now and then progress is called with the thousandths of the log done since the last call; what
    it raises ends the replay.

    Raises LogError for a log and configuration that do not fit, FmuError if the FMU refuses.
    """
    with Slave(installed("StiffnessEstimator"), "estimator") as slave:
        fmu = slave.fmu
        every = fmu.parameters(parameters(fmu, configuration))
        configuration.need_ports(str(every["modality"]))
        t_0 = begin(slave, configuration, None)
        samples = sample(log, configuration, float(every["samplePeriod"]))
        statistics = ReplayStatistics(len(samples.values))
        with slave.only_errors():
            run(slave, samples, statistics, t_0, progress=progress)
        # Nobody keeps this record: what identifies the file is not needed.
        return answer(slave, every, [learned_log(log, statistics, "")], samples, statistics)
