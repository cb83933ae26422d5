"""The job of `sigmahat estimate`: replays a log, writes its table and figure, and sums up."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from sigmahat.fmi.installed import fmu as installed_fmu
from sigmahat.fmi.instance import Fmu, Slave, Value
from sigmahat.logs.configuration import Configuration
from sigmahat.logs.log import Log
from sigmahat.logs.output import Table
from sigmahat.logs.replay import OUTPUTS, coefficients, parameters, replay
from sigmahat.logs.sampling import sample
from sigmahat.logs.trace import Trace

_CHUNK = 1 << 16  # ticks, about


@dataclass(frozen=True)
class Estimate:
    """What came out, in short."""

    log: Path
    """The file."""
    ticks: int
    """Of the estimator, over the log."""
    skipped: int
    """Ticks without an estimate: a measurement was missing."""
    T: float
    """Between ticks [s]."""
    parameters: dict[str, Value]
    """Of the estimator, by its names."""
    sigma: float
    """Stiffness at the end [N.m/rad]."""
    sigma_std: float
    """Its standard deviation, as far as the method knows [N.m/rad]."""
    confident: float
    """Share of the ticks in the second half at which the estimator was confident."""
    sigma_range: tuple[float, float]
    """Least and greatest in the second half [N.m/rad]."""
    tau_e_range: tuple[float, float]
    """Of the fitted torque in the second half [N.m]."""
    phi_range: tuple[float, float]
    """Of the deformation in the second half [rad]."""
    epsilon_rms: float
    """Of the prediction error of the torque in the second half [N.m]."""
    eta: Sequence[Sequence[float]]
    """Coefficients at the end, [size: rls.n x rls.m], (21)."""
    motor: dict[str, float]
    """Motor data at the end as method MatchedFilter corrected them, by output of the FMU."""
    notes: Sequence[str]
    """What the log needed."""

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
            "sigma range [N.m/rad]": self.sigma_range,
            "tau_e range [N.m]": self.tau_e_range,
            "phi range [rad]": self.phi_range,
            "epsilon rms [N.m]": self.epsilon_rms,
            "eta": self.eta,
            "motor": self.motor,
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

    From time to time progress is called with the thousandths done since the last call.

    Raises LogError for a log and configuration that do not fit, FmuError if the FMU refuses.
    """
    with Fmu(installed_fmu("StiffnessEstimator")) as fmu:
        start = parameters(fmu, configuration)
        every = fmu.parameters(start)
        configuration.need_ports(str(every["modality"]))
        samples = sample(log, configuration, float(every["samplePeriod"]))
        trace = Trace(len(samples.values))
        chunk = trace.bucket * max(1, _CHUNK // trace.bucket)
        units = {name: fmu.variable(name).unit for name in OUTPUTS}
        done = 0
        with (
            Slave(fmu, "estimator") as slave,
            Table(log, samples, units, folder / "estimate") as table,
        ):
            for outputs in replay(slave, samples, start, chunk):
                trace.add(outputs)
                table.add(outputs)
                now = done + len(outputs["valid"])
                progress(1000 * now // len(samples.values) - 1000 * done // len(samples.values))
                done = now
            eta = coefficients(slave, int(every["rls.n"]), int(every["rls.m"]))

    from sigmahat.logs.figure import Replay, draw
    from sigmahat.plotting.save import save

    save(
        draw,
        Replay(samples, trace, str(every["modality"]), str(every["method"])),
        folder / "estimate",
    )
    return Estimate(
        log=log.path,
        ticks=len(samples.values),
        skipped=trace.skipped,
        T=samples.T,
        parameters={n: v for n, v in every.items() if not n.startswith("rls.eta_0")},
        sigma=trace.last["sigma"],
        sigma_std=trace.last["sigma_std"],
        confident=trace.confident,
        sigma_range=trace.later("sigma"),
        tau_e_range=trace.later("tau_e"),
        phi_range=trace.later("phi"),
        epsilon_rms=trace.rms,
        eta=eta,
        motor={name: trace.last[name] for name in ("D_theta_hat", "B_hat", "tau_coulomb_hat")},
        notes=samples.notes,
    )


def summary(result: Estimate) -> str:
    """One screen."""
    p = result.parameters
    low, high = result.sigma_range
    torque = result.tau_e_range[1] - result.tau_e_range[0]
    relative = 100 * result.epsilon_rms / torque if torque else float("nan")
    lines = [f"{result.log}", *(f"  {note}" for note in result.notes), ""]
    lines += [
        f"method {p['method']}, modality {p['modality']}, T = {result.T:g} s, "
        f"rls.n = {p['rls.n']}, rls.m = {p['rls.m']}, "
        f"{'odd' if p['rls.symmetric'] else 'general'} polynomial",
        f"motor: B = {p['motor.B']:.4g} kg.m2, D_theta = {p['motor.D_theta']:.4g} N.m.s/rad, "
        f"gamma = {p['motor.gamma']:g}",
        "",
        "in the second half of the log:",
        f"  stiffness sigma       {low:10.4g} to {high:10.4g} N.m/rad",
        f"  torque tau_e, fitted  {result.tau_e_range[0]:10.4g} to {result.tau_e_range[1]:10.4g} "
        "N.m",
        f"  deformation phi       {result.phi_range[0]:10.4g} to {result.phi_range[1]:10.4g} rad",
        f"  prediction error RMS  {result.epsilon_rms:10.4g} N.m ({relative:.2g} % of the torque)",
        f"at the end: sigma = {result.sigma:.6g} N.m/rad, "
        f"standard deviation {result.sigma_std:.2g} N.m/rad; "
        f"{result.skipped} of {result.ticks} ticks skipped",
    ]
    if p["method"] == "MatchedFilter":
        B, D_theta, tau_coulomb = (
            result.motor[name] for name in ("B_hat", "D_theta_hat", "tau_coulomb_hat")
        )
        lines += [
            f"motor data found: B = {B:.4g} kg.m2, D_theta = {D_theta:.4g} N.m.s/rad, "
            f"Coulomb friction {tau_coulomb:.3g} N.m",
            f"confident {100 * result.confident:.3g} % of the second half",
        ]
    return "\n".join(lines)
