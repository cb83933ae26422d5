"""The job of `sigmahat estimate`: replays a log, writes its results, and shows them as text."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import ExitStack
from dataclasses import asdict, dataclass, replace
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
from numpy.typing import NDArray

from sigmahat.files.output import sha256, write_json
from sigmahat.files.tables import read_csv, write_csv
from sigmahat.fmi.model import Value, installed_model
from sigmahat.fmi.quoted import quoted
from sigmahat.fmi.series import Series
from sigmahat.recording import notes
from sigmahat.recording.configuration import Configuration
from sigmahat.recording.log import Log
from sigmahat.recording.notes import NoSignal, RecordingNote
from sigmahat.recording.recorded import recorded, temperature
from sigmahat.recording.replay import OUTPUTS
from sigmahat.recording.several_joints import NAMES, is_name
from sigmahat.result import sheet
from sigmahat.result.curve import (
    CURVE,
    Curve,
    curve_text,
    is_told,
    stiffness_in_the_middle,
    stiffness_points,
    write_curve,
)
from sigmahat.result.curve_of_log import POINTS, Answer, write_points
from sigmahat.result.data_sheet import MOTOR, UNITS, data_sheet, priors
from sigmahat.result.estimate_table import MCAP, REPLAYED, EstimateWriter, Replayed, mcap_file
from sigmahat.result.headline import Confidence, StiffnessChange, headline, told
from sigmahat.result.learned import LEARNED, read_learned, write_learned
from sigmahat.result.replayed_log import Replay

_MOTOR = ("D_theta_hat", "B_hat", "tau_coulomb_hat")
_UNITS = {
    "samplePeriod": "s",
    "sigma": "N.m/rad",
    "sigma_std": "N.m/rad",
    "sigma_range": "N.m/rad",
    "tau_e_range": "N.m",
    "phi": "rad",
    "phi_range": "rad",
    "reach": "rad",
    "epsilon_rms": "N.m",
    "misfit": "1",
    "relative": "1",
    "sigma_per_gain": "1",
    "tau_coulomb_hat": "N.m",
    **{f"{name}_hat": unit or "1" for name, unit in {**MOTOR, **UNITS}.items()},
    **notes.UNITS,
}
"""Units of the numbers with these keys in JSON; an interval has the unit of its value."""


@dataclass(frozen=True)
class Estimate:
    """The result of a replay in short."""

    log: Path  #: The file.
    ticks: int  #: Number of ticks of the estimator over the log.
    skipped: int  #: Ticks without an estimate: a measurement was missing.
    T: float  #: Time between ticks [s].
    parameters: dict[str, Value]  #: Parameters of the estimator by name, without rls.eta_0.
    sigma: float  #: Stiffness at the end [N.m/rad].
    sigma_std: float  #: Standard deviation of sigma, from the method [N.m/rad].
    confident: float
    """Fraction of the ticks in the second half at which the estimator was confident."""
    doubt: Mapping[str, float]
    """Fraction of the ticks in the second half without confidence, by reason: items of `doubt`."""
    misfit: float  #: Misfit of the model at the end [1]; 1 if the model holds.
    sigma_range: tuple[float, float]  #: Minimum and maximum in the second half [N.m/rad].
    tau_e_range: tuple[float, float]
    """Minimum and maximum of the fitted torque in the second half [N.m]."""
    phi_range: tuple[float, float]
    """Minimum and maximum of the deformation in the second half [rad]."""
    epsilon_rms: float  #: RMS of the prediction error of the torque in the second half [N.m].
    eta: Sequence[Sequence[float]]  #: Coefficients at the end, [size: rls.n x rls.m], (21).
    motor: dict[str, float]
    """Motor data that the method FilteredRegression estimated, at the end, by output of the FMU."""
    joint: dict[str, float]
    """Other estimates at the end, by output of the FMU: bias_hat, damping_hat and so on."""
    sigma_per_gain: float
    """Relative change of the stiffness per relative change of the gain of the torque [1]."""
    doubt_at_end: str
    """Reason for doubt at the last tick: item of `doubt`; "None" if the estimator was confident."""
    curve: Curve  #: Torque and stiffness against the deformation.
    changes: Sequence[StiffnessChange]  #: Changes that were detected.
    notes: Sequence[RecordingNote]  #: On reading the log and on its samples.
    learned_from: Sequence[str] = ()  #: Earlier logs that the estimator has processed.
    series: Series | None = None
    """The outputs at each tick; None if they were written into a folder."""

    @property
    def headline(self) -> str:
        """The stiffness in one line, with its changes, and whether it is trusted."""
        for note in self.notes:
            if isinstance(note, NoSignal) and not any(map(is_told, self.curve.branches)):
                return (
                    f"cannot tell: the torque is {note.value:g} throughout ({note.column}); "
                    "choose another column, or record with the motor on"
                )
        return headline(self.curve, self.confidence, self.changes)

    @property
    def confidence(self) -> Confidence:
        """How far the estimator trusted its estimate, at the end and in the second half."""
        return Confidence(self.doubt_at_end, {"None": self.confident, **self.doubt})

    def as_dict(self) -> dict[str, Any]:
        """Returns the result as a dictionary for JSON, with the units of its numbers by key.

        An inertia that is not above 0 is no result, and becomes None.
        """
        B = self.motor["B_hat"]
        return {
            "answer": self.headline,
            "units": _UNITS,
            "log": str(self.log),
            "ticks": self.ticks,
            "skipped": self.skipped,
            "samplePeriod": self.T,
            "sigma": self.sigma,
            "sigma_std": self.sigma_std,
            "confident": self.confident,
            "doubt": self.doubt,
            "misfit": self.misfit,
            "sigma_range": self.sigma_range,
            "tau_e_range": self.tau_e_range,
            "phi_range": self.phi_range,
            "epsilon_rms": self.epsilon_rms,
            "eta": self.eta,
            "curve": stiffness_points(self.curve),
            "motor": {**self.motor, "B_hat": B if B > 0 else None},
            "joint": self.joint,
            "sigma_per_gain": self.sigma_per_gain,
            "changes": [asdict(change) for change in self.changes],
            "notes": [note.as_dict() for note in self.notes],
            "learned_from": self.learned_from,
            "parameters": self.parameters,
        }


def estimate(
    log: Log,
    configuration: Configuration,
    folder: str | Path | None = None,
    progress: Callable[[int], object] = lambda thousandths: None,
    start_from: str | Path | None = None,
    mcap: bool = False,
    findings: list[dict[str, Any]] | None = None,
    given: datetime | None = None,
) -> Estimate:
    """Replays the log. Without a folder the outputs at all ticks are in the result, as `series`.

    If an existing `folder` is given, it gets these files: the table (estimate.csv or .parquet), the
    curve (estimate.curve.csv), its measured points (estimate.points.csv), and the figure
    (estimate.png and .svg). It also gets the data sheet of the joint (joint.json), the state of
    the estimator (state.json), and notes for the report (estimate.json), with the findings of the
    checks as data. With mcap, it also gets estimate.mcap.

    progress is called from time to time with the thousandths of the log done since the last call.
    With start_from, a folder of results or its state.json, the estimator starts from this state.
    `given` is the time of the recording, if the log does not have it.

    Raises LogError if log, configuration and start_from do not fit together, and
    ModuleNotFoundError without the package mcap.
    """
    learned = None if start_from is None else read_learned(Path(start_from))
    replay = Replay(log, configuration, learned)
    model = installed_model("StiffnessEstimator")
    if folder is None:
        kept: list[Mapping[str, NDArray[Any]]] = []
        replay.run(kept.append, progress)
        values = {name: np.concatenate([each[name] for each in kept]) for name in kept[0]}
        t = replay.samples.T * np.arange(len(replay.samples.values), dtype=np.float64)
        series = Series.of(model, values, replay.parameters, t)
        return replace(_result(replay, replay.answer().curve), series=series)
    folder = Path(folder)
    units = {name: model.variable(name).unit for name in OUTPUTS}
    with ExitStack() as files:
        table = files.enter_context(EstimateWriter(log, replay.samples, units, folder))
        adds: list[Callable[[Mapping[str, NDArray[Any]]], object]] = [table.add]
        if mcap:
            adds.append(files.enter_context(mcap_file(folder / MCAP, model, replay.samples.T)))
        digest = sha256(log.path)
        replay.run(lambda outputs: [add(outputs) for add in adds], progress, digest)
    write_learned(replay.estimator, replay.logs, folder / LEARNED.file)
    answered = replay.answer()
    at = recorded(log, configuration, given)
    recording = sheet.Recording(
        time=at.time.isoformat() if at.time else None,
        source=at.source.value,
        temperature=temperature(log, configuration),
    )
    contents = data_sheet(replay, answered.curve, recording)
    write_json(asdict(contents), folder / sheet.FORMAT.file)
    result = _result(replay, answered.curve)
    write_curve(answered.curve, folder / CURVE)
    write_points(answered.points, folder / POINTS)
    replayed = Replayed(
        *(REPLAYED.name, REPLAYED.version, str(log.path)),
        *(result.ticks, result.skipped, result.T),
        joint=configuration.joint,
        changes=result.changes,
        doubt=replay.statistics.doubts,
        notes=result.notes,
        findings=findings,
    )
    write_json(asdict(replayed), folder / REPLAYED.file)
    _save_figure(replay, answered, folder)
    return result


def _result(replay: Replay, found: Curve) -> Estimate:
    samples, statistics, every = replay.samples, replay.statistics, replay.parameters
    last, doubts, before = statistics.last, statistics.doubts, [e.file for e in replay.logs[:-1]]
    return Estimate(
        log=replay.log.path,
        ticks=len(samples.values),
        skipped=statistics.skipped,
        T=samples.T,
        parameters={n: v for n, v in every.items() if not n.startswith("rls.eta_0")},
        sigma=last["sigma"],
        sigma_std=last["sigma_std"],
        confident=doubts.pop("None", 0.0),
        doubt=doubts,
        misfit=last["misfit"],
        sigma_range=statistics.later["sigma"],
        tau_e_range=statistics.later["tau_e"],
        phi_range=statistics.later["phi"],
        epsilon_rms=statistics.rms,
        eta=replay.estimator.eta.tolist(),
        motor={name: last[name] for name in _MOTOR},
        joint={name: last[name] for name in last if name.endswith("_hat") and name not in _MOTOR},
        sigma_per_gain=last["sigma_per_gain"],
        doubt_at_end=statistics.last_doubt,
        curve=found,
        changes=replay.changes.found,
        notes=samples.notes,
        learned_from=before,
    )


def _save_figure(replay: Replay, answered: Answer, folder: Path) -> None:
    from sigmahat.result.log_figure import draw
    from sigmahat.show.figure import save

    save(lambda source: draw(*source), (replay, answered), folder / "estimate")


_NEGLIGIBLE = 0.1  # fraction of the standard deviation of a prior: smaller estimates are not shown


def continued_in_words(files: Sequence[str]) -> list[str]:
    """Sentence on the earlier logs from which an estimate continued; none without such logs."""
    return [f"continued from what was learned from {', '.join(files)}"] if files else []


def summary(result: Estimate) -> str:
    """Formats the result as text that fits on one screen."""
    p = result.parameters
    std = "for which the method gives no standard deviation"
    if p["method"] == "FilteredRegression":
        std = f"standard deviation {result.sigma_std:.2g} N.m/rad"
    said = [
        *continued_in_words(result.learned_from),
        *(note.in_words for note in result.notes),
    ]
    lines = [f"{result.log}", *(f"  {sentence}" for sentence in said), ""]
    lines += [
        f"method {p['method']}, modality {p['modality']}, T = {result.T:g} s, "
        f"rls.n = {p['rls.n']}, rls.m = {p['rls.m']}, "
        f"{'odd' if p['rls.symmetric'] else 'general'} polynomial",
        f"motor: B = {p['motor.B']:.4g} kg.m2, D_theta = {p['motor.D_theta']:.4g} N.m.s/rad, "
        f"gamma = {p['motor.gamma']:g}",
        "",
        *_second_half(result),
        f"at the end: sigma = {result.sigma:.6g} N.m/rad, {std}; "
        f"{result.skipped} of {result.ticks} ticks skipped",
    ]
    lines += curve_text(result.curve)
    if p["method"] == "FilteredRegression":
        lines += _found(result)
    return "\n".join(lines)


def _second_half(result: Estimate) -> Iterator[str]:
    (low, high), (least, most) = result.sigma_range, result.tau_e_range
    error = result.epsilon_rms
    relative = f"{100 * error / (most - least):.2g} %" if most - least > error else "100 % or more"
    yield "in the second half of the log:"
    yield f"  stiffness sigma       {low:10.4g} to {high:10.4g} N.m/rad"
    yield f"  torque tau_e, fitted  {least:10.4g} to {most:10.4g} N.m"
    yield f"  deformation phi       {result.phi_range[0]:10.4g} to {result.phi_range[1]:10.4g} rad"
    yield f"  prediction error RMS  {result.epsilon_rms:10.4g} N.m ({relative} of the torque)"
    if result.parameters["method"] == "FilteredRegression":
        yield from (f"  {each.in_words}" for each in told(result.changes, result.curve))
        reasons = ", ".join(f"{item} {100 * share:.3g} %" for item, share in result.doubt.items())
        why = f" ({reasons})" if reasons else ""
        yield f"  not confident         {100 * (1 - result.confident):10.3g} % of the time{why}"


def _found(result: Estimate) -> Iterator[str]:
    """Formats the motor data and all estimates of FilteredRegression that are not negligible."""
    motor = result.motor
    B = motor["B_hat"]
    inertia = f"B = {B:.4g} kg.m2" if B > 0 else f"no B ({B:.4g} kg.m2 is impossible)"
    yield (
        f"motor data found: {inertia}, D_theta = "
        f"{motor['D_theta_hat']:.4g} N.m.s/rad, Coulomb friction {motor['tau_coulomb_hat']:.3g} N.m"
    )
    others = [
        f"{sheet.WORDS[name]} {value:.3g} {UNITS[name]}".rstrip()
        for name, std in priors(result.parameters).items()
        if abs(value := result.joint[f"{name}_hat"]) > _NEGLIGIBLE * std
    ]
    yield f"of the joint: {', '.join([f'misfit of the model {result.misfit:.3g}', *others])}"


JOINTS = "joints.csv"
"""Name of the table with rows for each joint of a log, next to the folders of the joints."""
_TITLES = (
    *("joint", "setPoint", "phi [rad]", "sigma [N.m/rad]", "sigma low [N.m/rad]"),
    *("sigma high [N.m/rad]", "confident", "last change at [s]", "last change [%]"),
)


def write_joints(found: Mapping[str, Estimate], folder: Path) -> None:
    """Writes the stiffness of each joint in the middle of its data, for each setting.

    The stiffness is the one after the last change in the log, if the log has a change.
    """
    rows = []
    for name, each in found.items():
        doubt = each.confidence.doubt
        sure = "yes" if doubt is None else f"no: {doubt}"
        change = _last_change(each.changes)
        for branch in each.curve.branches:
            phi, sigma, interval = stiffness_in_the_middle(branch)
            stiffness = [phi, sigma, *(interval or (None, None))]
            rows.append([name, branch.set_point, *stiffness, sure, *change])
        if not each.curve.branches:
            rows.append([name, *[None] * 5, sure, *change])
    write_csv(folder / JOINTS, _TITLES, rows)


def _last_change(changes: Sequence[StiffnessChange]) -> tuple[float | None, float | None]:
    """Returns time [s] and size [%] of the last change; None for what is not known."""
    if not changes:
        return None, None
    last = changes[-1]
    return last.t, None if last.relative is None else 100 * last.relative


def read_joints(folder: Path) -> tuple[list[str], pa.Table]:
    """Reads the names of the joints of a folder, which each have a folder there, and their table.

    Raises ValueError for a file that write_joints() did not write, OSError without such a file.
    """
    table = read_csv(folder / JOINTS)
    if table.column_names[:1] != ["joint"]:
        raise ValueError(f"{folder / JOINTS}: expected a table of `estimate`; run `estimate` again")
    names = list(dict.fromkeys(map(str, table["joint"].to_pylist())))
    if wrong := [name for name in names if not is_name(name)]:
        raise ValueError(
            f"{folder / JOINTS}: expected names of joints ({NAMES}), got {quoted(wrong[0])}; run "
            "`estimate` again"
        )
    return names, table
