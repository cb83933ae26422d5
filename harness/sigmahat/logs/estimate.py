"""The job of `sigmahat estimate`: replays a log, writes table, figure, data sheet and state."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sigmahat.files.output import sha256
from sigmahat.fmi.instance import Slave, Value
from sigmahat.fmi.opened import installed
from sigmahat.joint import sheet
from sigmahat.joint.curve import CURVE, Curve, write_curve
from sigmahat.joint.curve_text import stiffness_points
from sigmahat.joint.stored import LearnedLog
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.curve import Answer, answer
from sigmahat.logs.data_sheet import data_sheet
from sigmahat.logs.learned import LEARNED, Learned, go_on, read_learned, write_learned
from sigmahat.logs.log import Log
from sigmahat.logs.measured import POINTS, write_points
from sigmahat.logs.notes_file import REPLAYED, write_replayed
from sigmahat.logs.output import EstimateWriter
from sigmahat.logs.replay import OUTPUTS, coefficients, parameters, play
from sigmahat.logs.sampling import Samples, sample
from sigmahat.logs.statistics import ReplayStatistics

_CHUNK = 1 << 14  # ticks that are replayed at a time, about
_MOTOR = ("D_theta_hat", "B_hat", "tau_coulomb_hat")


@dataclass(frozen=True)
class Estimate:
    """The result of a replay in short."""

    log: Path
    """The file."""
    ticks: int
    """Number of ticks of the estimator over the log."""
    skipped: int
    """Ticks without an estimate: a measurement was missing."""
    T: float
    """Time between ticks [s]."""
    parameters: dict[str, Value]
    """Parameters of the estimator, by its names; those of rls.eta_0 are left out."""
    sigma: float
    """Stiffness at the end [N.m/rad]."""
    sigma_std: float
    """Its standard deviation as the method gives it [N.m/rad]."""
    confident: float
    """Share of the ticks in the second half at which the estimator was confident."""
    doubt: Mapping[str, float]
    """Share of the ticks in the second half at which it was not, by reason: items of `doubt`."""
    misfit: float
    """Misfit of the model at the end [1]; 1 where it holds."""
    sigma_range: tuple[float, float]
    """Minimum and maximum in the second half [N.m/rad]."""
    tau_e_range: tuple[float, float]
    """Minimum and maximum of the fitted torque in the second half [N.m]."""
    phi_range: tuple[float, float]
    """Minimum and maximum of the deformation in the second half [rad]."""
    epsilon_rms: float
    """RMS of the prediction error of the torque in the second half [N.m]."""
    eta: Sequence[Sequence[float]]
    """Coefficients at the end, [size: rls.n x rls.m], (21)."""
    motor: dict[str, float]
    """Motor data that the method FilteredRegression estimated, at the end, by output of the FMU."""
    joint: dict[str, float]
    """What else it estimated, at the end, by output of the FMU: bias_hat, damping_hat and so on."""
    sigma_per_gain: float
    """Relative change of the stiffness with a relative change of the gain of the torque [1]."""
    curve: Curve
    """Torque and stiffness over the deformation."""
    notes: Sequence[str]
    """What had to be done to the samples of the log, in sentences."""
    learned_from: Sequence[str] = ()
    """Logs that were learned from before this one."""

    def as_dict(self) -> dict[str, Any]:
        """For JSON; units are in the names."""
        return {
            "log": str(self.log),
            "ticks": self.ticks,
            "skipped": self.skipped,
            "samplePeriod [s]": self.T,
            "sigma [N.m/rad]": self.sigma,
            "sigma_std [N.m/rad]": self.sigma_std,
            "confident": self.confident,
            "doubt": self.doubt,
            "misfit": self.misfit,
            "sigma range [N.m/rad]": self.sigma_range,
            "tau_e range [N.m]": self.tau_e_range,
            "phi range [rad]": self.phi_range,
            "epsilon rms [N.m]": self.epsilon_rms,
            "eta": self.eta,
            "curve": stiffness_points(self.curve),
            "motor": self.motor,
            "joint": self.joint,
            "sigma_per_gain": self.sigma_per_gain,
            "notes": self.notes,
            "learned_from": self.learned_from,
            "parameters": self.parameters,
        }


def estimate(
    log: Log,
    configuration: Configuration,
    folder: Path,
    progress: Callable[[int], object] = lambda thousandths: None,
    start_from: Path | None = None,
) -> Estimate:
    """Replays the log and writes into folder: the table (estimate.csv or .parquet), the curve
    (estimate.curve.csv) and the measured points behind it (estimate.points.csv), the figure
    (estimate.png and .svg), the data sheet of the joint (joint.json), what was learned
    (state.json), and notes for the report (estimate.json).

    Now and then progress is called with the thousandths of the log done since the last call.
    With start_from, a folder of results or its state.json, the estimator goes on from there.

    Raises LogError for a log and configuration that do not fit, and for a start_from that does not
    fit the configuration; FmuError if the FMU refuses.
    """
    learned = None if start_from is None else read_learned(start_from)
    with Slave(installed("StiffnessEstimator"), "estimator") as slave:
        fmu = slave.fmu
        start = parameters(fmu, configuration)
        every = fmu.parameters(start)
        configuration.need_ports(str(every["modality"]))
        t_0 = begin(slave, configuration, learned)
        samples = sample(log, configuration, float(every["samplePeriod"]))
        statistics = ReplayStatistics(len(samples.values))
        units = {name: fmu.variable(name).unit for name in OUTPUTS}
        with EstimateWriter(log, samples, units, folder) as table:
            run(slave, samples, statistics, t_0, table.add, progress)
        eta = coefficients(slave, int(every["rls.n"]), int(every["rls.m"]))
        logs = [*(learned.logs if learned else []), learned_log(log, statistics, sha256(log.path))]
        write_learned(slave, every, logs, folder / LEARNED.file)
        path, last = configuration.path, statistics.last
        answered = answer(slave, every, logs, samples, statistics)
        write_curve(answered.curve, folder / CURVE)
        write_points(answered.points, folder / POINTS)
        found = data_sheet(slave, every, logs, path, last, statistics.last_doubt, answered.curve)
        sheet.write(found, folder / sheet.FORMAT.file)
    result = _estimate(log, samples, statistics, every, eta, logs[:-1], answered.curve)
    write_replayed(
        log.path, result.ticks, result.skipped, result.T, result.notes, folder / REPLAYED.file
    )
    _save_figure(samples, statistics, every, answered, folder)
    return result


def begin(slave: Slave, configuration: Configuration, learned: Learned | None) -> float:
    """Initialises a slave; with what was learned before, it goes on from there.

    Returns the time that it has reached [s]. Raises LogError, FmuError if something does not fit.
    """
    start = parameters(slave.fmu, configuration)
    slave.initialize(start)
    if learned is None:
        return 0.0
    return go_on(slave, learned, slave.fmu.parameters(start), configuration.path)


def run(
    slave: Slave,
    samples: Samples,
    statistics: ReplayStatistics,
    t_0: float,
    add: Callable[[Mapping[str, Any]], object] = lambda outputs: None,
    progress: Callable[[int], object] = lambda thousandths: None,
) -> None:
    """Plays all samples, from the time t_0 [s]; statistics and `add` are given the outputs."""
    chunk = statistics.bucket * max(1, _CHUNK // statistics.bucket)
    done, ticks = 0, len(samples.values)
    for outputs in play(slave, samples, chunk, t_0):
        statistics.add(outputs)
        add(outputs)
        now = done + len(outputs["valid"])
        progress(1000 * now // ticks - 1000 * done // ticks)
        done = now


def learned_log(log: Log, statistics: ReplayStatistics, digest: str) -> LearnedLog:
    """The record of a log that was replayed to its end; digest is the SHA-256 of its file."""
    return LearnedLog(
        file=str(log.path),
        sha256=digest,
        ticks=statistics.ticks,
        skipped=statistics.skipped,
        phi=statistics.used("phi"),
        set_point=statistics.used("setPoint"),
    )


def _estimate(
    log: Log,
    samples: Samples,
    statistics: ReplayStatistics,
    every: Mapping[str, Value],
    eta: Sequence[Sequence[float]],
    before: Sequence[LearnedLog],
    learned_curve: Curve,
) -> Estimate:
    last, doubts = statistics.last, statistics.doubts
    notes = list(samples.notes)
    if before:
        notes.insert(0, f"continued from what was learned from {', '.join(b.file for b in before)}")
    return Estimate(
        log=log.path,
        ticks=len(samples.values),
        skipped=statistics.skipped,
        T=samples.T,
        parameters={n: v for n, v in every.items() if not n.startswith("rls.eta_0")},
        sigma=last["sigma"],
        sigma_std=last["sigma_std"],
        confident=doubts.pop("None", 0.0),
        doubt=doubts,
        misfit=last["misfit"],
        sigma_range=statistics.later("sigma"),
        tau_e_range=statistics.later("tau_e"),
        phi_range=statistics.later("phi"),
        epsilon_rms=statistics.rms,
        eta=eta,
        motor={name: last[name] for name in _MOTOR},
        joint={name: last[name] for name in last if name.endswith("_hat") and name not in _MOTOR},
        sigma_per_gain=last["sigma_per_gain"],
        curve=learned_curve,
        notes=notes,
        learned_from=[each.file for each in before],
    )


def _save_figure(
    samples: Samples,
    statistics: ReplayStatistics,
    every: Mapping[str, Value],
    answered: Answer,
    folder: Path,
) -> None:
    from sigmahat.logs.figure import Replay, draw
    from sigmahat.plotting.save import save

    replayed = Replay(
        samples,
        statistics,
        str(every["modality"]),
        str(every["method"]),
        answered.curve,
        answered.points,
    )
    save(draw, replayed, folder / "estimate")
