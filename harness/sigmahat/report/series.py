"""Contents of a report from signals over time: a reproduction, or a log with its estimates."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.csv
import pyarrow.parquet
from numpy.typing import NDArray

from sigmahat.report.plots import COLORS, TRUE, Contents, Panel, Table, Trace
from sigmahat.report.reduction import Reduced, reduce

_TIME = "time t [s]"
_WIDE = 3.5  # of the truth, so that an estimate on top of it still shows it
_QUANTITIES = (
    # Title, axis, {variable: label}, the noisy first, which would hide the others. {} stands for
    # the side of an antagonistic pair.
    (
        "Flexibility torque",
        "tau_e [N.m]",
        {
            "tau_e_residual{}": "by the motor data",
            "plant.tau_e_measured{}": "sensor",
            "plant.tau_e{}": "true",
            "tau_e{}": "fitted, f(theta_c, phi)",
        },
    ),
    ("Deformation", "phi [rad]", {"plant.phi{}": "true", "phi{}": "as the estimator sees it"}),
    (
        "Motor velocity",
        "theta_dot [rad/s]",
        {"plant.theta_dot{}": "true", "theta_dot{}": "filtered"},
    ),
    (
        "Positions as measured",
        "position [rad]",
        {"plant.theta_measured{}": "motor, theta", "plant.q_measured": "link, q"},
    ),
    ("Set-point", "set-point [1]", {"setPoint{}": "set-point of the regression"}),
)
_OUTER = 1.0  # percent of a stiffness at either end that do not set the scale
_ESTIMATE = "estimate."


def reproduction(folder: Path) -> Contents:
    """From what `sigmahat reproduce` wrote."""
    table = _read_csv(folder / "table.csv")
    modalities = {
        path.stem: _read_csv(path) for path in sorted(folder.glob("*.csv")) if path.stem != "table"
    }
    # Its other files may be there, but not its own.
    modalities = {n: t for n, t in modalities.items() if t.column_names[0] == "t [s]"}
    if not modalities or table.column_names[:2] != ["estimation", "seeds"]:
        raise ValueError(f"{folder}: no result of `sigmahat reproduce`; run it again")
    order = [str(n).split(" ")[0] for n in table["estimation"].to_pylist()]
    names = sorted(modalities, key=lambda n: order.index(n) if n in order else len(order))
    if len({len(modalities[n]) for n in names}) > 1:
        raise ValueError(
            f"{folder}: files of different lengths; run `sigmahat reproduce` again, "
            "with an empty folder as --out"
        )
    # What is shown of one estimator is shown of the one that needs no sensor of torque.
    main = "RESIDUAL" if "RESIDUAL" in names else names[0]
    signals = _signals(modalities[main])
    for name in names:
        for variable, values in _signals(modalities[name]).items():
            if re.fullmatch(r"sigma(_\d)?", variable):
                signals[f"{name} {variable}"] = values
    reduced = reduce(signals.pop("t"), signals)
    panels = [
        *_stiffness(reduced, names),
        *_quantities(reduced, main if len(names) > 1 else ""),
    ]
    rows = [[_number(cell) for cell in row.values()] for row in table.to_pylist()]
    seeds = table["seeds"][0].as_py()
    lines = [
        f"{len(modalities[main])} samples of {seeds} seed{'s' if seeds > 1 else ''}; "
        "the plots show the first"
        if seeds > 1
        else f"{len(modalities[main])} samples",
        *_sampling(reduced),
    ]
    shown = [i for i, title in enumerate(table.column_names) if any(r[i] != "-" for r in rows)]
    return Contents(
        f"Reproduction: {folder.resolve().name}",
        lines,
        [
            Table(
                "Performance indices",
                [table.column_names[i] for i in shown],
                [[row[i] for i in shown] for row in rows],
            )
        ],
        panels,
        reduced.every if reduced.bucket > 1 else None,
    )


def log(folder: Path) -> Contents:
    """From what `sigmahat estimate` wrote."""
    path = next(folder.glob("estimate.parquet"), folder / "estimate.csv")
    table = _read_csv(path) if path.suffix == ".csv" else _read_parquet(path)
    signals = _signals(table, _ESTIMATE)
    valid = signals.pop("valid", None)
    if "t" not in signals or "sigma" not in signals or valid is None:
        raise ValueError(f"{path}: no table of `sigmahat estimate`; run it again")
    samples = len(valid)
    used = valid.astype(bool)
    half = np.arange(samples) >= samples // 2
    rows = []
    for name, values in signals.items():
        if name not in ("t", "a", "rho"):
            title = next(t for t in table.column_names if _variable(t) == _ESTIMATE + name)
            later = values[half & used]
            cells = [values[-1], *([later.min(), later.max(), _rms(later)] if len(later) else [])]
            cells += [np.nan] * (4 - len(cells))
            rows.append([title.removeprefix(_ESTIMATE), *(_number(float(c)) for c in cells)])
    skipped = int(np.count_nonzero(~used))
    duration = signals["t"][-1] - signals["t"][0]
    reduced = reduce(signals.pop("t"), signals)
    return Contents(
        f"Log: {folder.resolve().name}",
        [
            f"{samples} rows over {duration:.6g} s; in {skipped} of them the estimator skipped "
            "the tick",
            *_sampling(reduced),
        ],
        [Table("Estimates", ["", "at the end", "least *", "greatest *", "RMS *"], rows)],
        [*_stiffness(reduced, []), *_quantities(reduced, "")],
        reduced.every if reduced.bucket > 1 else None,
    )


def _rms(values: NDArray[Any]) -> float:
    return float(np.sqrt(np.mean(values**2)))


def _number(value: object) -> str:
    """A cell for a value; "-" for what is not known."""
    if value is None or value == "":
        return "-"
    if not isinstance(value, float):
        return str(value)
    if np.isnan(value):
        return "-"
    return f"{value:.4g}"


def _sampling(reduced: Reduced) -> list[str]:
    if reduced.bucket == 1:
        return ["Every sample is in the plots: zoom in until single counts of the encoders show."]
    first, last = reduced.every
    return [
        f"Every sample is in the plots from {first:.6g} s to {last:.6g} s, the shaded part: zoom in"
        f" there until single counts of the encoders show. Elsewhere they keep the least and the "
        f"greatest of every {reduced.bucket} samples."
    ]


def _read_csv(path: Path) -> pa.Table:
    try:
        return pa.csv.read_csv(path)
    except (pa.ArrowInvalid, pa.ArrowKeyError) as error:
        raise ValueError(f"{path}: not readable as CSV; run the command that wrote it") from error


def _read_parquet(path: Path) -> pa.Table:
    """The columns of the estimator alone; a log may have many others."""
    try:
        names = [n for n in pa.parquet.read_schema(path).names if n.startswith(_ESTIMATE)]
        return pa.parquet.read_table(path, columns=names)
    except (pa.ArrowException, OSError) as error:
        raise ValueError(f"{path}: damaged; run `sigmahat estimate` again") from error


def _variable(title: str) -> str:
    """Name of a column without its unit."""
    return title.partition(" [")[0]


def _signals(table: pa.Table, prefix: str = "") -> dict[str, NDArray[Any]]:
    """Columns with numbers by name without unit."""
    found = {}
    for title in table.column_names:
        name = _variable(title)
        kind = table.schema.field(title).type
        numeric = (
            pa.types.is_floating(kind) or pa.types.is_integer(kind) or pa.types.is_boolean(kind)
        )
        if numeric and name.startswith(prefix):
            found[name.removeprefix(prefix)] = np.asarray(table[title].to_numpy(), dtype=np.float64)
    return found


def _sides(names: Mapping[str, Any] | Sequence[str], pattern: str) -> Iterator[str]:
    """The sides "", "_1", "_2" of which there is a variable."""
    return (side for side in ("", "_1", "_2") if pattern.format(side) in names)


def _stiffness(reduced: Reduced, modalities: Sequence[str]) -> Iterator[Panel]:
    """Stiffness and its relative error; of one estimator if there are no modalities."""
    signals = reduced.signals
    for side in ("", "_1", "_2"):
        true = signals.get(f"plant.sigma{side}")
        keys = {n: f"{n} sigma{side}" for n in modalities} or {"estimate": f"sigma{side}"}
        keys = {label: key for label, key in keys.items() if key in signals}
        if not keys:
            continue
        of = f" of side {side[1:]}" if side else ""
        lines = [
            Trace(label, color, reduced.t, signals[key])
            for (label, key), color in zip(keys.items(), COLORS, strict=False)
        ]
        truth = [] if true is None else [Trace("true", TRUE, reduced.t, true, width=_WIDE)]
        scale = lines[0].y[len(lines[0].y) // 20 :] if true is None else true
        yield Panel(
            f"Stiffness{of}",
            _TIME,
            "sigma [N.m/rad]",
            [*truth, *lines],
            y_range=_range(scale),
        )
        if true is not None:
            with np.errstate(divide="ignore", invalid="ignore"):
                errors = [
                    Trace(line.label, line.color, reduced.t, _positive(line.y, true), width=1.1)
                    for line in lines
                ]
            yield Panel(
                f"Relative error of the stiffness{of}",
                _TIME,
                "|error| [%]",
                errors,
                y_log=True,
                y_range=(1e-5, 2e2),
            )


def _positive(estimate: NDArray[Any], true: NDArray[Any]) -> NDArray[np.float32]:
    """Relative error [%]; nan for 0, which a logarithmic scale does not have."""
    error: NDArray[np.float32] = (100 * np.abs(estimate / true - 1)).astype(np.float32)
    error[~(error > 0) | ~np.isfinite(error)] = np.nan
    return error


def _range(values: NDArray[Any]) -> tuple[float, float]:
    finite = values[np.isfinite(values)]
    if not len(finite):
        return 0.0, 1.0
    low, high = np.percentile(finite, [_OUTER, 100 - _OUTER]).tolist()
    margin = 0.2 * ((high - low) or abs(high) or 1.0)
    return low - margin, high + margin


def _quantities(reduced: Reduced, of: str) -> Iterator[Panel]:
    signals = reduced.signals
    for title, axis, variables in _QUANTITIES:
        first = [name for name in variables if "{}" in name]
        sides = list(dict.fromkeys(s for name in first for s in _sides(signals, name)))
        for side in sides:
            traces: list[Trace] = []
            for name, label in variables.items():
                values = signals.get(name.format(side))
                # What is constant was not connected: no sensor, no set-point.
                if values is None or (label != "true" and np.nanmin(values) == np.nanmax(values)):
                    continue
                true = label == "true"
                color = TRUE if true else COLORS[len([t for t in traces if t.color != TRUE])]
                traces.append(Trace(label, color, reduced.t, values, width=_WIDE if true else 1.1))
            if traces:
                where = f" of side {side[1:]}" if side else ""
                whose = f", {of}" if of and not title.startswith("Positions") else ""
                yield Panel(f"{title}{where}{whose}", _TIME, axis, traces)
