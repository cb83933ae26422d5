"""The job of `sigmahat estimate`: replays a log, writes its table and figure."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Fmu, Slave, Value
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.log import Log
from sigmahat.logs.output import EstimateWriter
from sigmahat.logs.replay import OUTPUTS, coefficients, parameters, replay
from sigmahat.logs.sampling import Samples, sample
from sigmahat.logs.statistics import ReplayStatistics

_CHUNK = 1 << 16  # ticks that are replayed at a time, about
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
    """Motor data that the method MatchedFilter estimated, at the end, by output of the FMU."""
    joint: dict[str, float]
    """What else it estimated, at the end, by output of the FMU: bias_hat, damping_hat and so on."""
    sigma_per_gain: float
    """Relative change of the stiffness with a relative change of the gain of the torque [1]."""
    notes: Sequence[str]
    """What had to be done to the samples of the log, in sentences."""

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
            "motor": self.motor,
            "joint": self.joint,
            "sigma_per_gain": self.sigma_per_gain,
            "notes": self.notes,
            "parameters": self.parameters,
        }


def estimate(
    log: Log,
    configuration: Configuration,
    folder: Path,
    progress: Callable[[int], object] = lambda thousandths: None,
) -> Estimate:
    """Replays the log and writes estimate.csv or .parquet, estimate.png and .svg into folder.

    Now and then progress is called with the thousandths of the log done since the last call.

    Raises LogError for a log and configuration that do not fit, FmuError if the FMU refuses.
    """
    with Fmu(installed_fmu("StiffnessEstimator")) as fmu:
        start = parameters(fmu, configuration)
        every = fmu.parameters(start)
        configuration.need_ports(str(every["modality"]))
        samples = sample(log, configuration, float(every["samplePeriod"]))
        statistics = ReplayStatistics(len(samples.values))
        chunk = statistics.bucket * max(1, _CHUNK // statistics.bucket)
        units = {name: fmu.variable(name).unit for name in OUTPUTS}
        done = 0
        with (
            Slave(fmu, "estimator") as slave,
            EstimateWriter(log, samples, units, folder) as table,
        ):
            for outputs in replay(slave, samples, start, chunk):
                statistics.add(outputs)
                table.add(outputs)
                now = done + len(outputs["valid"])
                progress(1000 * now // len(samples.values) - 1000 * done // len(samples.values))
                done = now
            eta = coefficients(slave, int(every["rls.n"]), int(every["rls.m"]))

    _save_figure(samples, statistics, every, folder)
    last, doubts = statistics.last, statistics.doubts
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
        notes=samples.notes,
    )


def _save_figure(
    samples: Samples, statistics: ReplayStatistics, every: Mapping[str, Value], folder: Path
) -> None:
    from sigmahat.logs.figure import Replay, draw
    from sigmahat.plotting.save import save

    replayed = Replay(samples, statistics, str(every["modality"]), str(every["method"]))
    save(draw, replayed, folder / "estimate")
