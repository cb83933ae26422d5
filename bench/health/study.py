"""The figures of the study: python -m health.study --logs FOLDER --years 400.

Joint-years are drawn from the logs that health.simulate wrote: the log of a day is one of the logs
of its condition, at another temperature. All joints have their turn. An alarm counts at the first
night at which a quantity is above its limit.
"""

import argparse
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from datetime import datetime, timedelta, timezone
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from health.joints import FRICTION, TORQUE_CONSTANT
from health.simulate import JOINTS
from sigmahat.health.change import Series, largest_change, largest_episode
from sigmahat.health.logs import LogResult, by_joint
from sigmahat.health.quantities import Name, Quantities, Quantity, quantities
from sigmahat.health.threshold import LOGS_A_YEAR, START, limit
from sigmahat.result.excitation import Excitation
from sigmahat.result.sheet import Prior, Together

Array = NDArray[np.float64]

SEED = 6464
BEFORE, AFTER = 100, 60  # logs before a step, and logs after which it has to be found
RUNS = 12  # of a joint and condition
_NIGHTS = np.unique(np.geomspace(8, LOGS_A_YEAR, 40).astype(int))
_MOST_AFTER = 400  # logs after a step until which a delay is followed
_SMOOTHED = 0.5  # share of the claimed error that is added to a log
_BEGIN = datetime(2026, 1, 1, tzinfo=timezone.utc)
_LEVELS = {"spring": (0.0, -0.025, -0.05, -0.075, -0.1), "gap": (0.0, 2e-4, 4e-4, 6e-4, 8e-4, 1e-3)}


@dataclass(frozen=True)
class PoolLog:
    """A simulated log."""

    together: Together
    excitation: Excitation
    warm: float  # temperature, -1 to 1


@dataclass(frozen=True)
class Pools:
    """The logs of a joint by condition."""

    joint: int
    unknown: Mapping[str, Sequence[PoolLog]]
    exact: Mapping[str, Sequence[PoolLog]]


def read(folder: Path, joint: int) -> Pools:
    pools: dict[str, dict[str, list[PoolLog]]] = {"unknown": {}, "exact": {}}
    for line in (folder / f"{joint}.jsonl").read_text().splitlines():
        values = json.loads(line)
        warm = np.random.default_rng([joint, values["log"], 7]).uniform(-1.0, 1.0)
        for priors, of_condition in pools.items():
            fields = values[priors]
            excitation = Excitation(**fields.pop("excitation"))
            prior = {name: Prior(**each) for name, each in fields.pop("prior").items()}
            log = PoolLog(
                Together(**fields, prior=prior), excitation, 1 / (1 - TORQUE_CONSTANT * warm)
            )
            of_condition.setdefault(values["condition"], []).append(log)
    return Pools(joint, pools["unknown"], pools["exact"])


def drawn(pool: Sequence[PoolLog], rng: np.random.Generator, day: int) -> LogResult:
    """Draws the log of a day: one of a pool, at another temperature, and a little off.

    The torque constant changes all torques, and friction has its own change. Half of the claimed
    error is added (smoothed bootstrap): no two logs are equal.
    """
    log = pool[int(rng.integers(len(pool)))]
    warm = rng.uniform(-1.0, 1.0)
    together = log.together
    values, covariance = np.array(together.values), np.array(together.covariance)
    change = (1 - TORQUE_CONSTANT * log.warm) / (1 - TORQUE_CONSTANT * warm) - 1
    factors = 1 + change * np.array(together.per_gain) / np.where(values, values, 1.0)
    for name in ("D_theta", "tau_coulomb"):
        friction = (1 - FRICTION * warm) / (1 - FRICTION * log.warm)
        factors[len(together.phi) + together.quantities.index(name)] *= friction
    factors = np.where(values, factors, 1.0)
    values = values * factors
    covariance = covariance * np.outer(factors, factors)
    stds = np.sqrt(np.diag(covariance))
    correlation = covariance / np.outer(stds, stds).clip(1e-300)
    roots, vectors = np.linalg.eigh(np.where(np.outer(stds, stds) > 0, correlation, 0.0))
    off = vectors @ (np.sqrt(np.maximum(roots, 0.0)) * rng.standard_normal(len(stds)))
    values = values + _SMOOTHED * stds * off
    excitation = replace(log.excitation, torque=(1 + change) * log.excitation.torque)
    return LogResult(
        joint="joint",
        time=_BEGIN + timedelta(days=day),
        place=str(day),
        digests=[str(day)],
        together=replace(together, values=values.tolist(), covariance=covariance.tolist()),
        excitation=excitation,
        torque_gain=0.02,
        doubt="None",
    )


def seen(results: Sequence[LogResult]) -> Quantities:
    (joint,) = by_joint(results)
    return quantities(joint)


def of(found: Quantities, name: Name) -> Quantity | None:
    return next((each for each in found.every if each.name is name), None)


def largest_z(series: Series) -> float:
    """Returns the largest |z| of a change or an episode; 0 without any."""
    change, episode = largest_change(series), largest_episode(series)
    return max(abs(change.z) if change else 0.0, episode.z if episode else 0.0)


def alarm_at(quantity: Quantity, z: float, nights: Sequence[int]) -> int | None:
    """Returns the first of the nights, counted in logs of the joint, with an alarm."""
    for night in nights:
        count = int(np.searchsorted(quantity.logs, night))
        if count and largest_z(quantity.series.part(0, count)) > z:
            return night
    return None


@dataclass(frozen=True)
class Delay:
    """One run of a softer spring."""

    joint: int
    shift: float  # change over the scatter of healthy logs [1]
    logs: int | None  # until it is found; None: not found
    cusum: int | None  # until the CUSUM finds it


@dataclass(frozen=True)
class Study:
    every: Sequence[Pools]
    rng: np.random.Generator

    def step(
        self, before: str, after: str, logs: int, exact: bool = False
    ) -> list[tuple[Pools, Quantities]]:
        """Runs of all joints with a change of condition behind BEFORE logs."""
        found = []
        for pools in self.every:
            own = pools.exact if exact else pools.unknown
            for _ in range(RUNS):
                conditions = [before] * BEFORE + [after] * logs
                days = [drawn(own[c], self.rng, day) for day, c in enumerate(conditions)]
                found.append((pools, seen(days)))
        return found

    def called(self, before: str, after: str, name: Name, exact: bool = False) -> tuple[int, int]:
        """Number of runs in which a quantity is said to have changed after the step; of runs."""
        runs = self.step(before, after, AFTER, exact)
        count = 0
        for _, found in runs:
            quantity, z = of(found, name), limit(START, len(found.every))
            count += quantity is not None and largest_z(quantity.series) > z
        return count, len(runs)

    def false_alarms(self, years: int) -> tuple[Mapping[float, int], Mapping[Name, int]]:
        """Joint-years with a false alarm by the rate that is set; quantities at START."""
        rates = (0.1, 0.01, START)
        counts, names = dict.fromkeys(rates, 0), dict[Name, int]()
        for year in range(years):
            pool = self.every[year % len(self.every)].unknown["healthy"]
            found = seen([drawn(pool, self.rng, day) for day in range(LOGS_A_YEAR)])
            limits = [limit(rate, len(found.every)) for rate in rates]
            largest = {each.name: _largest(each) for each in found.every}
            for rate, z in zip(rates, limits, strict=True):
                counts[rate] += max(largest.values()) > z
            for name, value in largest.items():
                names[name] = names.get(name, 0) + int(value > limits[-1])
        return counts, names

    @cached_property
    def softer(self) -> list[Delay]:
        """The runs of a step of -5 %."""
        found: list[Delay] = []
        for pools, seen_of in self.step("healthy", "spring -0.05", _MOST_AFTER):
            quantity, z = of(seen_of, Name.STIFFNESS), limit(START, len(seen_of.every))
            assert quantity is not None
            nights = range(BEFORE + 1, BEFORE + _MOST_AFTER + 1)
            night = alarm_at(quantity, z, nights)
            logs = np.array(quantity.logs)
            healthy = quantity.series.values[logs < BEFORE]
            worn = quantity.series.values[logs >= BEFORE]
            shift, scatter = worn.mean() - healthy.mean(), healthy.std(ddof=1)
            each_year = START / len(seen_of.every) / LOGS_A_YEAR
            cusum = _cusum(worn, healthy.mean(), scatter, shift, each_year)
            delay = None if night is None else int(np.sum((logs >= BEFORE) & (logs < night)))
            found.append(Delay(pools.joint, abs(shift) / scatter, delay, cusum))
        return found

    def sizes(self) -> Iterator[tuple[int, float, bool, float, float]]:
        """For each joint and each softer spring, from all simulated logs, each once: joint, true
        change of the logarithm, whether it is found, size and half of its interval."""
        for pools in self.every:
            for level in _LEVELS["spring"][1:]:
                pool = [*pools.unknown["healthy"], *pools.unknown[f"spring {level:g}"]]
                days = [drawn([log], self.rng, day) for day, log in enumerate(pool)]
                seen_of = seen(days)
                quantity, z = of(seen_of, Name.STIFFNESS), limit(START, len(seen_of.every))
                change = largest_change(quantity.series) if quantity else None
                if change is not None:
                    is_found = abs(change.z) > z
                    truth = float(np.log1p(level))
                    yield pools.joint, truth, is_found, change.size, change.half_width()

    def slowly(self, kind: str, most: float, name: Name) -> list[float | None]:
        """The change in 100 days at which it is found, run by run; None: not found by then."""
        found: list[float | None] = []
        for pools in self.every:
            for _ in range(RUNS):
                days = [drawn(pools.unknown["healthy"], self.rng, day) for day in range(BEFORE)]
                for day in range(100):
                    wanted = most * (day + 1) / 100
                    level = min(_LEVELS[kind], key=lambda each: abs(each - wanted))
                    condition = f"{kind} {level:g}" if level else "healthy"
                    log = drawn(pools.unknown[condition], self.rng, BEFORE + day)
                    days.append(_moved(log, kind, wanted, level))
                seen_of = seen(days)
                quantity, z = of(seen_of, name), limit(START, len(seen_of.every))
                nights = range(BEFORE + 2, BEFORE + 101)
                night = alarm_at(quantity, z, nights) if quantity else None
                found.append(None if night is None else most * (night - BEFORE) / 100)
        return found


def _largest(quantity: Quantity) -> float:
    """Returns the largest |z| of all nights."""
    counts = np.searchsorted(quantity.logs, _NIGHTS)
    return max((largest_z(quantity.series.part(0, int(each))) for each in counts), default=0.0)


def _moved(log: LogResult, kind: str, wanted: float, level: float) -> LogResult:
    """Takes a log from the level that was simulated to the one of the day."""
    values = list(log.together.values)
    count = len(log.together.phi)
    if kind == "spring":
        values[:count] = [each * (1 + wanted) / (1 + level) for each in values[:count]]
    else:
        # A dead zone that a log shows; one that it does not show stays hidden.
        values[-1] *= wanted / level if level else 1.0
    return replace(log, together=replace(log.together, values=values))


def _cusum(worn: Array, mean: float, scatter: float, shift: float, rate: float) -> int | None:
    """Returns the logs until a CUSUM finds a shift whose size and scatter it knows.

    Its limit has the given rate of false alarms, by D. Siegmund, Sequential Analysis, 1985.
    """
    delta = abs(shift) / scatter
    k = delta / 2
    b = 0.1
    while (np.exp(2 * k * b) - 2 * k * b - 1) / (2 * k**2) < 1 / rate:
        b += 0.01
    h = max(b - 1.166, 0.0)
    total = 0.0
    for count, value in enumerate(np.sign(shift) * (worn - mean) / scatter, 1):
        total = max(0.0, total + float(value) - k)
        if total > h:
            return count
    return None


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--logs", type=Path, required=True, help="folder of health.simulate")
    parser.add_argument("--joints", type=int, nargs="+", default=list(JOINTS))
    parser.add_argument("--years", type=int, default=400, help="joint-years without a change")
    parser.add_argument("--only", choices=["years", "softer", "slowly", "called"])
    arguments = parser.parse_args()
    every = [read(arguments.logs, joint) for joint in arguments.joints]
    parts: Mapping[str, Callable[[], None]] = {
        "years": lambda: _years(Study(every, np.random.default_rng([SEED, 1])), arguments.years),
        "softer": lambda: _softer(Study(every, np.random.default_rng([SEED, 2]))),
        "slowly": lambda: _slowly(Study(every, np.random.default_rng([SEED, 3]))),
        "called": lambda: _called(Study(every, np.random.default_rng([SEED, 4]))),
    }
    for name, part in parts.items():
        if arguments.only in (None, name):
            part()


def _years(study: Study, years: int) -> None:
    counts, names = study.false_alarms(years)
    for rate, count in counts.items():
        print(f"{count} of {years} healthy joint-years with an alarm, at a rate of {rate:g}")
    print("quantities at the start value:", {name.name: n for name, n in names.items() if n})


def _softer(study: Study) -> None:
    runs, pairs = study.softer, list[tuple[int, int]]()
    for joint in sorted({run.joint for run in runs}):
        own = [run for run in runs if run.joint == joint]
        both = [(r.logs, r.cusum) for r in own if r.logs is not None and r.cusum is not None]
        found = sum(run.logs is not None for run in own)
        mean = [float(np.mean([pair[i] for pair in both])) if both else np.nan for i in (0, 1)]
        print(
            f"joint {joint}: {np.mean([run.shift for run in own]):.2f} times the scatter; found in "
            f"{found} of {len(own)} after {mean[0]:.1f} logs, CUSUM {mean[1]:.1f}"
        )
        pairs += both
    delay, known = (float(np.mean([pair[i] for pair in pairs])) for i in (0, 1))
    print(f"delay {delay:.1f} logs, CUSUM {known:.1f}: ratio {delay / known:.2f}")
    sizes = list(study.sizes())
    for what, some in (("all", sizes), ("found", [each for each in sizes if each[2]])):
        inside = sum(abs(size - truth) <= half for _, truth, _, size, half in some)
        print(f"size of the change in its interval, {what}: {inside} of {len(some)}")


def _slowly(study: Study) -> None:
    for kind, most, name, at in (
        ("spring", -0.1, Name.STIFFNESS, 0.07),
        ("gap", 1e-3, Name.BACKLASH, 6e-4),
    ):
        found = study.slowly(kind, most, name)
        early = sum(each is not None and abs(each) < at for each in found)
        each = [abs(level) for level in found if level is not None]
        print(
            f"{kind} to {most:g} in 100 days: found before {at:g} in {early} of {len(found)} runs, "
            f"in the median at {np.median(each):.2g}, never in {len(found) - len(each)}"
        )


def _called(study: Study) -> None:
    for before, after, name, exact in (
        ("healthy", "gain", Name.STIFFNESS, False),
        ("healthy", "gain", Name.STIFFNESS, True),
        ("healthy", "gain", Name.GAIN, False),
        ("healthy", "friction", Name.STIFFNESS, False),
        ("healthy", "friction", Name.COULOMB, False),
        ("healthy", "payload", Name.STIFFNESS, False),
        ("one motion", "another motion", Name.STIFFNESS, False),
    ):
        count, runs = study.called(before, after, name, exact)
        known = "exact inertia" if exact else "inertia by the log"
        print(f"{after}, {known}: called {name.value} in {count} of {runs}")


if __name__ == "__main__":
    main()
