"""The curve of a log alone, without the files of `estimate`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Fmu, Slave
from sigmahat.joint.curve import Curve
from sigmahat.joint.records import LearnedLog
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.curve import curve
from sigmahat.logs.estimate import begin, run
from sigmahat.logs.log import Log
from sigmahat.logs.measured import MeasuredPoints, with_what_was_learned
from sigmahat.logs.replay import parameters
from sigmahat.logs.sampling import sample
from sigmahat.logs.statistics import ReplayStatistics


@dataclass(frozen=True)
class Answer:
    """What `estimate` finds."""

    curve: Curve
    """Torque and stiffness over the deformation."""
    points: MeasuredPoints
    """That stand behind it."""


def answer(
    log: Log, configuration: Configuration, progress: Callable[[int], object] = lambda _: None
) -> Answer:
    """Replays a log as `estimate` does, and writes nothing.

    Now and then progress is called with the thousandths of the log done since the last call; what
    it raises ends the replay.

    Raises LogError for a log and configuration that do not fit, FmuError if the FMU refuses.
    """
    with Fmu(installed_fmu("StiffnessEstimator")) as fmu, Slave(fmu, "estimator") as slave:
        every = fmu.parameters(parameters(fmu, configuration))
        configuration.need_ports(str(every["modality"]))
        t_0 = begin(slave, configuration, None)
        samples = sample(log, configuration, float(every["samplePeriod"]))
        statistics = ReplayStatistics(len(samples.values))
        with slave.only_errors():
            run(slave, samples, statistics, t_0, progress=progress)
        points = statistics.points(str(every["method"]))
        # Nobody keeps this record: what identifies the file is not needed.
        learned = LearnedLog(
            file=str(log.path),
            sha256="",
            ticks=statistics.ticks,
            skipped=statistics.skipped,
            phi=statistics.used("phi"),
            set_point=statistics.used("setPoint"),
        )
        found = curve(slave, every, [learned], points)
        if every["method"] == "MatchedFilter":
            points = with_what_was_learned(slave, every, samples)
    return Answer(found, points)
