"""FilteredRegression in numpy, written from the headers in c/filtered_regression/, with dense
matrices.

It shares nothing with the C code except the direction of motion, which has its own tests.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np

from c_library import Array, Library
from dense_information import SIDES, Information, Long, inverse
from dense_signals import (
    CURVE,
    GAPS,
    GROUPS,
    PLAYS,
    SENSOR,
    TORQUE,
    Filtered,
    Held,
    Inputs,
    Parameters,
    bandwidth,
    decimation,
    resolution,
    through,
)

LEAST = 1e-9
START: Parameters = {  # start values, with rls.n for the AwAS and an unknown inertia
    **{"method": 2, "modality": 1, "samplePeriod": 1e-3, "torque.held": 0},
    **{"rls.n": 3, "rls.m": 3, "rls.symmetric": 1, "range.phi": 0.3, "range.setPoint": 100.0},
    **{"encoder.theta": 40000.0, "encoder.q": 40000.0, "noise.tau": 3.2e-3, "noise.tau_e": 3.2e-2},
    **{"motor.D_theta": 1e-3, "motor.B": 2.3e-5, "motor.gamma": 50.0},
    **{"regression.bandwidth": 350.0, "regression.slow": 0.05, "regression.drift": 0.0},
    **{"regression.memory": 20.0, "prior.tau_e": 45.0, "prior.nominal": 0.0, "prior.D_theta": 0.2},
    **{"prior.B": 0.1, "prior.tau_coulomb": 0.02, "prior.torque_gain": 0.02, "prior.bias": 0.05},
    **{"prior.damping": 7.5e-3, "prior.load_friction": 0.1, "prior.eccentric": 5e-4},
    **{"prior.delay": 2e-3, "prior.reversal": 2e-3, "prior.power": 1.0, "prior.gap": 0.02},
    **{"prior.hysteresis": 0.01, "prior.eccentric_motor": 1e-4},
}
EQUATION = ("POWER", "NOMINAL", "VISCOUS", "COULOMB", "INERTIA")


class Posterior:
    """Prior and data of some columns: covariance P and estimates of both sides."""

    def __init__(self, chosen: list[int], weight: float, prior_B: float, drive: int) -> None:
        n = len(chosen)
        self.removal_error = 0.05 / prior_B if prior_B > 0 else 0.0
        self.chosen, self.weight = chosen, weight
        self.drive = chosen.index(drive) if drive in chosen else -1
        self.of_drive = np.zeros(2)  # noise in its column: information, and by the gain
        self.surplus = self.removed = self.spread = 0.0
        self.P: Long = np.eye(n, dtype=np.longdouble)
        self.beta: Long = np.zeros((n, SIDES), dtype=np.longdouble)

    def sums(self, data: Information) -> tuple[Long, Long]:
        """Prior and data: information matrix, and right-hand sides."""
        n, own = len(self.chosen), [*self.chosen, data.size, data.size + 1]
        matrix: Long = self.weight * data.matrix[np.ix_(own, own)]
        return matrix[:n, :n] + np.eye(n, dtype=np.longdouble), matrix[:n, n:]

    def solve(self, data: Information) -> None:
        matrix, right = self.sums(data)
        self.P = inverse(matrix)
        self.beta = self.P @ right

    def learn(self, row: Long, w: float) -> float:
        """Returns the variance of the prediction of y over that of the sample."""
        x, sides = row[self.chosen], row[-SIDES:]
        w = w * self.weight
        Px = self.P @ x
        rho = x @ Px * w
        error = sides - x @ self.beta
        self.beta = self.beta + np.outer(Px, error) * (w / (1 + rho))
        self.P = self.P - np.outer(Px, Px) * (w / (1 + rho))
        return float(rho)

    def remove(self, information: float, prior_B: float) -> None:
        self.surplus += information
        back = min(self.surplus, float(1 / self.P[-1, -1] - 1))
        if back <= 0:
            return
        gain = back / (1 - back * self.P[-1, -1])
        along = self.P[:, -1].copy()
        right = np.array([0, 1 / prior_B]) + self.beta[-1]
        self.beta = self.beta + gain * np.outer(along, right)
        self.P = self.P + gain * np.outer(along, along)
        self.surplus -= back
        self.removed += back

    def remove_noise(self) -> None:
        """Of the torque in its own column."""
        N, by_gain = self.of_drive
        if self.drive < 0 or N <= 0:
            return
        beta, P = self.weighted()
        i = self.drive
        D = 1 / P[i, i]
        left = max(D - 1 - N, 1e-3 * (D - 1))
        removed_noise = D - 1 - left
        share = left / (left + removed_noise + (0.2 * by_gain) ** 2)
        by_gain *= removed_noise / N
        sides = D * beta[i] - np.array([by_gain, 0])
        back = D - 1 - left * share
        # The same, for the matrices without the weight of b: A - back e e', A beta - right e
        right = np.array([by_gain, 0]) + (1 - share) * sides
        gain = 1 / (1 - back * self.P[i, i])
        along = self.P[:, i].copy()
        self.beta = self.beta + gain * np.outer(along, back * self.beta[i] - right)
        self.P = self.P + back * gain * np.outer(along, along)

    def weighted(self) -> tuple[Long, Long]:
        """Estimates and covariance with the weight of the data about b after the removal."""
        if self.removed <= 0:
            return self.beta, self.P
        of_b = max(1 / self.P[-1, -1] - 1, 0)
        unsure = (self.removal_error * self.removed) ** 2
        share = of_b / (of_b + self.removed + self.spread + unsure)
        variance = 1 / (1 + of_b * share)
        along = self.P[:, -1] / self.P[-1, -1]
        mean = self.beta[-1] / self.P[-1, -1] * share * variance
        beta = self.beta + np.outer(along, mean - self.beta[-1])
        return beta, self.P + np.outer(along, along) * (variance - self.P[-1, -1])


@dataclass
class Blocks:
    """Blocks of rows, 50 ms, under a smooth window."""

    all: Information
    walking: Information
    recent: Information
    length: int
    energy: float
    energy_second: float
    count: float = 0.0
    recent_count: float = 0.0
    gained: float = 0.0
    rows: list[Any] = field(default_factory=list)

    def judged(self) -> bool:
        return self.count >= 20


def start_blocks(n: int, w: float, T: float, K: int) -> Blocks:
    length = max(math.floor(0.05 / (K * T) + 0.5), 4)
    h = np.append(
        np.repeat(window(np.arange(length), length), K), np.zeros(math.ceil(30 / (w * T)))
    )
    filtered = [through(np.append(0.0, h), order, w, T) for order in (0, 2)]
    energy, of_second = (float(np.sum(f**2) / np.sum(h**2)) for f in filtered)
    every, walking, recent = (Information(n, precision) for precision in (LEAST, LEAST, 1.0))
    return Blocks(every, walking, recent, length, energy, of_second)


def window(k: Any, length: int) -> Any:
    x = (k + 0.5) / length
    return 16 * (x * (1 - x)) ** 2


def threshold(N: float) -> float:
    return N + 3 * math.sqrt(2 * N)


class Oracle:
    """The estimator; `run` gives all outputs of all ticks."""

    def __init__(
        self, c: Library, p: Parameters, z: Array, eta_0: Array | None, modality: Array
    ) -> None:
        self.c, self.p, self.z, self.eta_0, self.modality = c, p, z, eta_0, modality
        self.good = np.all(np.isfinite(z), axis=1)
        self.T, self.w, self.K = p["samplePeriod"], bandwidth(p), decimation(p)
        self.runs = self.find_runs()
        self.inputs = Inputs(p, np.nan_to_num(z, posinf=0.0, neginf=0.0), self.runs, eta_0)
        self.columns = self.inputs.columns
        self.n = n = len(self.columns)
        self.kinds = [kind for kind, _, _ in self.columns]
        self.data = Information(n, LEAST)
        self.used = [1, 0, 0, 0, 0, 0, 0]
        self.phi_min, self.phi_max = math.inf, -math.inf
        self.live = self.posterior(0, 1.0)
        self.blocks = start_blocks(n, self.w, self.T, self.K)
        self.q = self.factor = 1.0
        self.surplus = self.spread = self.rounding = 0.0
        self.of_drive = np.zeros(2)
        self.trial = self.last_trial = self.row = 0
        self.since = self.pause = self.epsilon = self.rho = 0.0
        self.samples: list[int] = []  # of the next row
        self.steps: list[Callable[[], None]] = []  # what the last row still changes
        self.friction_drifts = self.known = False
        self.beta: Long = np.zeros(n, dtype=np.longdouble)
        self.sigma = self.y = self.delay = 0.0
        self.resting = self.unsure = 0
        self.settling, self.starting = 0.0, 12 / self.w
        self.rough, self.excess, self.excess_mean = 0.0, 1.0, 1.0
        self.switched: list[tuple[int, int, int]] = []  # tick, group, whether it is used
        self.changes = 0  # passes in which the recent data agreed by themselves
        self.out: dict[str, list[Any]] = {}
        pulse = np.concatenate([[0.0], np.full(self.K, 1 / self.K), np.zeros(20000)])
        response = [through(pulse, order, self.w, self.T) for order in (0, 2)]
        self.gain, self.gain_second = (float(np.sum(of**2)) for of in response)
        self.start_pass()

    def find_runs(self) -> list[slice]:
        """Good samples in sequence with one modality."""
        runs, start = [], None
        for k in range(len(self.z) + 1):
            ends = k == len(self.z) or not self.good[k]
            if start is not None and (ends or self.modality[k] != self.modality[k - 1]):
                runs.append(slice(start, k))
                start = None
            if not ends and start is None:
                start = k
        return runs

    # Columns of a posterior

    def is_distinct(self, i: int) -> bool:
        kind, index, _ = self.columns[i]
        covered = (self.phi_max - self.phi_min) / 4 / self.p["range.phi"]
        widths = {"DEAD_ZONE": GAPS, "HYSTERESIS": PLAYS}.get(kind)
        return widths is None or widths[index] < covered

    def group(self, i: int) -> int:
        return GROUPS.get(self.kinds[i], 0)

    def posterior(self, trial: int, weight: float) -> Posterior:
        chosen = [
            i
            for i in range(self.n)
            if self.group(i) == 0
            or (self.group(i) != trial and self.used[self.group(i)] and self.is_distinct(i))
        ]
        if trial:
            chosen += [i for i in self.of_group(trial) if self.is_distinct(i)]
        drive = self.kinds.index("DRIVE") if "DRIVE" in self.kinds else -1
        return Posterior(chosen, weight, self.p["prior.B"], drive)

    def of_group(self, group: int) -> list[int]:
        return [i for i in range(self.n) if self.group(i) == group]

    # Passes

    def start_pass(self) -> None:
        least = max(1.0, self.q, self.excess_mean)
        weight = 1 / (least if self.trial else self.factor)
        self.build = self.posterior(self.trial, weight)
        self.build.surplus = self.surplus * weight
        self.build.spread = self.spread * weight**2
        self.build.of_drive = self.of_drive * weight
        self.row = 0

    def end_pass(self, k: int) -> None:
        if not self.trial:
            self.build.solve(self.data)
            self.live = self.build
            self.build = Posterior([], 1.0, 0.0, -1)  # until the next pass starts
            if self.p["prior.B"] > 0:
                self.live.remove(0.0, self.p["prior.B"])
            self.live.remove_noise()
            self.set_beta()
            return
        own = sum(self.group(i) != self.trial for i in self.build.chosen)
        gain = self.evidence(len(self.build.chosen)) - self.evidence(own)
        N, used = self.blocks.count, self.used[self.trial]
        used = 1 if gain > 3 + 0.05 * N else 0 if gain < 0.025 * N else used
        if used != self.used[self.trial]:
            self.switched.append((k, self.trial, used))
        self.used[self.trial] = used

    def evidence(self, first: int) -> float:
        """Logarithm of the evidence of the first columns, but for a constant."""
        matrix, sides = self.build.sums(self.data)
        A, right = matrix[:first, :first], sides[:first, 1]
        _, log_determinant = np.linalg.slogdet(A.astype(float))
        return float((right @ inverse(A) @ right - log_determinant) / 2)

    def whole_misfit(self) -> float:
        """Of all blocks, at the estimate."""
        sums = self.blocks.walking if self.friction_drifts else self.blocks.all
        return sums.squares(self.beta) / (self.blocks.count - len(self.live.chosen) / 2)

    def recent_misfit(self) -> float:
        """Of the recent blocks without the prior, if it is beyond chance."""
        N = self.blocks.recent_count
        if N < 20 or self.friction_drifts or self.p["regression.drift"] > 0:
            return 0.0
        squares = self.blocks.recent.squares(self.beta) - float(self.beta @ self.beta)
        return squares / N if squares > threshold(N) else 0.0

    def can_judge(self) -> bool:
        return self.blocks.judged() and len(self.live.chosen) < self.blocks.count

    def judge(self) -> None:
        N = self.blocks.count
        if not self.can_judge():
            return
        self.factor = 1.0
        whole = self.whole_misfit()
        self.q = max(whole, self.recent_misfit())
        if self.p["regression.memory"] > 0:
            self.factor = max(1.0, self.q)
            t = threshold(N) / N
            if whole > t:
                self.factor = max(self.factor, 1 + (whole - t) * max(1, N / 5))

    def plan(self) -> None:
        was_trial = self.trial != 0
        self.judge()
        self.trial = 0
        if was_trial or not self.blocks.judged():
            return
        groups = len(self.used) - 1
        for _ in range(groups):
            self.last_trial = self.last_trial % groups + 1
            if any(self.is_distinct(i) for i in self.of_group(self.last_trial)):
                self.trial = self.last_trial
                return

    def walk_friction(self, sums: Information, time: float) -> None:
        for i, kind in enumerate(self.kinds):
            if kind in ("VISCOUS", "COULOMB"):
                sums.walk(np.eye(self.n, dtype=np.longdouble)[i], 1e-3 * time)

    def watch_friction(self, time: float) -> None:
        blocks, N = self.blocks, self.blocks.count
        self.walk_friction(blocks.walking, time)
        if 2 * self.n < N:
            constant, walking = blocks.all.rest, blocks.walking.rest
            if walking < 0.8 * constant and constant > (N - self.n) * threshold(N) / N:
                self.friction_drifts = True
            elif walking > 0.95 * constant:
                self.friction_drifts = False
        if self.friction_drifts:
            self.walk_friction(self.data, time)

    def forget(self, time: float) -> None:
        blocks, memory, drift = self.blocks, self.p["regression.memory"], self.p["regression.drift"]
        gained, blocks.gained = blocks.gained, 0.0
        keep = math.exp(-10 * gained / memory) if memory else 1.0
        blocks.recent.fade(keep)
        blocks.recent_count *= keep
        both = (self.data, blocks.all, blocks.walking)
        if self.factor > 1.5 and self.can_judge():
            N = blocks.recent_count
            has_changed = N > 20 and blocks.recent.rest < threshold(N)
            self.changes += has_changed
            keep = math.exp(-gained / (memory / 5 if has_changed else memory))
            for sums in both:
                sums.fade(keep)
            blocks.count *= keep
            self.surplus *= keep
            self.spread *= keep**2
            self.of_drive *= keep
            self.rounding *= keep
        v = np.where([kind in CURVE for kind in self.kinds], self.before[: self.n], 0)
        power = v @ v
        if drift > 0 and power > 0:
            variance = drift * time / (power + self.R)
            self.rounding /= 1 + variance * float(v @ self.data.matrix[: self.n, : self.n] @ v)
            for sums in both:
                sums.walk(v, variance)

    def advance_pass(self, k: int) -> None:
        if self.row < self.n:
            self.row = min(self.row + (self.K + 1) // 2, self.n)
            return
        stage = self.row - self.n
        if stage == 0:
            self.end_pass(k)
            self.plan()
        if stage == 1 and not self.trial:
            self.watch_friction(self.since)
        if stage == 2:
            self.pause = 0.0
        if stage == 2 and not self.trial:
            self.forget(self.since)
            self.since = 0.0
        if stage < 3:
            self.row += 1
        elif self.pause >= 0.0201 * 0.05 * self.blocks.count:
            self.start_pass()

    # Samples

    def friction_variance(self, unknown: float) -> float:
        if "COULOMB" not in self.kinds or unknown == 0:
            return 0.0
        C = self.kinds.index("COULOMB")
        own = self.live.chosen.index(C)
        variance = float(self.beta[C] ** 2 + self.live.weighted()[1][own, own])
        largest = self.p["motor.gamma"] * self.p["prior.tau_coulomb"] * unknown
        return float(largest**2 * variance)

    def noise(self) -> tuple[float, float]:
        """After the filter: of the torque [(N.m)2], of theta by its variance [(N.m/rad)2]."""
        torque = self.gain * (self.p["motor.gamma"] * self.p["noise.tau"]) ** 2
        inertial = (self.p["motor.gamma"] ** 2 * self.p["motor.B"]) ** 2 * self.gain_second
        return torque, inertial

    def share_of_torque(self, unknown: float) -> float:
        torque, inertial = self.noise()
        rough = max(self.rough, resolution(self.p["encoder.theta"]) ** 2 / 12)
        return torque / (torque + inertial * rough + self.friction_variance(unknown))

    def watch(self, roughness: float) -> None:
        torque, inertial = self.noise()
        rounded = torque + inertial * resolution(self.p["encoder.theta"]) ** 2 / 12
        self.rough += min(self.T / 0.1, 1) * (roughness - self.rough)
        self.excess = max(1.0, (torque + inertial * self.rough) / rounded)
        self.excess_mean += min(self.T / 5, 1) * (self.excess - self.excess_mean)

    def variance(self, filtered: Filtered, at: int) -> tuple[float, float]:
        """R, and the factor in it by errors that last."""
        p = self.p
        counts = sum(resolution(p[f"encoder.{name}"]) ** 2 for name in ("theta", "q"))
        rounding = self.sigma**2 * counts / 12
        stays = rounding * self.resting
        if filtered.measured:
            R = rounding + p["noise.tau_e"] ** 2
        else:
            friction = self.friction_variance(filtered.unknown_f[at])
            R = rounding + (p["motor.gamma"] * p["noise.tau"]) ** 2
            R = R * (1 + 0.3 * (self.excess - 1)) + friction * 16 / (3 * self.w * self.T)
            stays += friction * self.unsure
        last = (1 + stays / R) ** 2
        return R * last / self.K, last

    def full_block(self, measured: bool) -> tuple[Long, float, float]:
        """Mean row, its variance, and as how many independent blocks it counts."""
        blocks = self.blocks
        h = window(np.arange(blocks.length), blocks.length)
        w = np.array([entry[1] for entry in blocks.rows])
        mean = sum(h[i] * w[i] * entry[0] for i, entry in enumerate(blocks.rows)) / (h @ w)
        variance = (h**2 @ w) / (h @ w) ** 2 * blocks.energy
        if not measured:
            V = (self.p["motor.gamma"] ** 2 * self.p["motor.B"]) ** 2
            V *= np.mean([entry[3] for entry in blocks.rows])
            variance += V * blocks.energy_second * np.sum(h**2) / (self.K * np.sum(h) ** 2)
        count = np.sum(h**2 / np.array([entry[2] for entry in blocks.rows])) / np.sum(h**2)
        return mean, float(variance), float(count)

    def take_block(self, step: int, measured: bool) -> None:
        """One regression a step; the last step counts the block."""
        blocks = self.blocks
        if len(blocks.rows) < blocks.length:
            return
        mean, variance, count = self.full_block(measured)
        if step < 3:
            (blocks.all, blocks.walking, blocks.recent)[step].take(mean, 1 / variance)
            return
        blocks.count += count
        blocks.recent_count += count
        blocks.gained += count * blocks.length * self.K * self.T
        blocks.rows.clear()

    def learn(self, k: int, filtered: Filtered, row: Long, rough: Array) -> None:
        at = k - filtered.run.start
        R, last = self.variance(filtered, at)
        self.R, self.before = R, row
        counts = [resolution(self.p[key]) for key in ("encoder.theta", "encoder.q")]
        self.rounding += self.gain * float(np.square(counts).sum()) / 12 / R
        epsilon = float(row[-1] - row[:-SIDES] @ self.beta)
        if "DRIVE" in self.kinds and not filtered.measured and row[-SIDES] != 0:
            self.remove_noise(row, self.share_of_torque(filtered.unknown_f[at]), epsilon, R)
        self.epsilon = float(row[-1] - row[:-SIDES] @ self.beta)
        self.rho = self.live.learn(row, 1 / R)
        mean_rough = float(np.mean(rough[self.samples]))
        prior_B = self.p["prior.B"]
        if prior_B > 0:
            inertial = 0.0 if filtered.measured else self.p["motor.gamma"] ** 2 * self.p["motor.B"]
            theta = self.z[filtered.run, 0]
            moved = np.mean([i > 0 and theta[i] != theta[i - 1] for i in self.samples])
            V = mean_rough + 0.056 * moved * resolution(self.p["encoder.theta"]) ** 2 / 12
            N = (inertial * prior_B) ** 2 * self.gain_second * V / R
            Q = 6 * (N / prior_B) ** 2
            self.surplus += N
            self.spread += Q
            for posterior in (self.live, self.build):
                posterior.spread += Q * posterior.weight**2
            self.build.surplus += N * self.build.weight
            self.live.remove(N * self.live.weight, prior_B)
        self.set_beta()

        def step(number: int) -> None:
            if number == 0:
                self.since += self.K * self.T
                self.pause += self.K * self.T
            if number == 1:
                self.data.take(row, 1 / R)
            if number == 2:
                self.blocks.rows.append((row, 1 / R, last, mean_rough))
            if 2 <= number <= 5:
                self.take_block(number - 2, filtered.measured)
            if number == 6:
                self.advance_pass(k)

        self.steps = [partial(step, number) for number in range(7)]

    def take_steps(self) -> None:
        """They are spread over the ticks between two rows."""
        for _ in range(math.ceil(7 / max(self.K - 1, 1))):
            if self.steps:
                self.steps.pop(0)()

    def remove_noise(self, row: Long, share: float, epsilon: float, R: float) -> None:
        """Of the torque from its own column, where y contains it, too."""
        i, torque = self.kinds.index("DRIVE"), row[-SIDES]
        slope = row[i] / torque
        returned = np.clip(slope * self.beta[i], -0.5, 0.5)
        row[i] *= abs(1 - share * epsilon / (1 - share * returned) / torque)
        of_drive = (1 - share) * self.noise()[0] * slope * np.array([slope, 1]) / R
        self.of_drive += of_drive.astype(float)
        self.build.of_drive += of_drive.astype(float) * self.build.weight

    def was_at_rest(self, filtered: Filtered, at: int, row: Long) -> bool:
        if filtered.measured or self.starting <= 0:
            return True
        self.starting -= self.K * self.T
        p = self.p
        x = row[self.live.chosen]
        error = row[-1] - x @ self.beta[self.live.chosen]
        # What a joint has beside the equation must not hide a slow motion.
        x = np.where([self.kinds[i] in EQUATION for i in self.live.chosen], x, 0)
        inertial = p["motor.gamma"] ** 2 * p["motor.B"] * resolution(p["encoder.theta"])
        variance = self.gain * (p["motor.gamma"] * p["noise.tau"]) ** 2
        variance += inertial**2 / 12 * self.gain_second
        variance += self.friction_variance(filtered.unknown_f[at]) + x @ self.live.weighted()[1] @ x
        if error**2 <= 25 * variance:
            return True
        self.starting, self.settling = 0.0, 12 / self.w
        return False

    # One run of samples

    def run(self) -> dict[str, Array]:
        for number, run in enumerate(self.runs):
            measured = self.modality[run.start] == SENSOR
            filtered = Filtered(self.c, self.p, self.inputs, self.z, run, measured)
            if number:
                self.starting, self.settling = 0.0, 12 / self.w
                self.samples.clear()
                if len(self.blocks.rows) < self.blocks.length:
                    self.blocks.rows.clear()
            self.go(filtered)
        return {name: np.array(values, dtype=np.float64) for name, values in self.out.items()}

    def go(self, filtered: Filtered) -> None:
        run = filtered.run
        theta = np.concatenate([np.full(4, self.z[run.start, 0]), self.z[run, 0]])
        rough = np.convolve(theta, [1, -4, 6, -4, 1], "valid") ** 2 / 70
        derivatives = filtered.torque_derivatives()
        errors = {
            i: filtered.encoder_error(i)
            for i, kind in enumerate(self.kinds)
            if kind in ("SIN_M", "COS_M")
        }
        load = Held(self.w, self.T)
        loads = np.zeros(len(rough))
        for k in range(run.start, run.stop):
            at = k - run.start
            self.deform(k, at)
            if at:
                self.unsure = self.unsure + 1 if filtered.unknown[at] > 0 else 0
                tau_e = self.torque(k) if self.known else self.y
                loads[at] = load.step(-abs(tau_e) * filtered.sign[at])
            self.settling = max(self.settling - self.T, 0)
            settled, complete = self.settling <= 0, False
            if settled:
                if not filtered.measured:
                    self.watch(rough[at])
                self.samples.append(at)
                complete = len(self.samples) == self.K
            if complete:
                row = self.mean_row(filtered, loads, derivatives, errors)
                settled = complete = self.was_at_rest(filtered, at, row)
                if complete:
                    self.learn(k, filtered, row, rough)
                self.samples.clear()
            if not complete or self.K == 1:
                self.take_steps()
            if not settled:
                self.epsilon = self.rho = 0.0
            self.report(k, filtered.y[at], settled)
            self.y = float(filtered.y[at]) - self.epsilon

    def mean_row(
        self,
        filtered: Filtered,
        loads: Array,
        derivatives: tuple[Array, Array],
        errors: Mapping[int, tuple[Array, Array]],
    ) -> Long:
        """Of the samples; what depends on the estimate does so by the present one."""

        def mean(x: Array) -> Any:
            return np.mean(x[self.samples], axis=0)

        sides = mean(filtered.sides)
        row = np.concatenate([mean(filtered.rows), sides]).astype(np.longdouble)
        for i, (kind, _, prior) in enumerate(self.columns):
            if kind == "LOAD":
                row[i] = 0.0 if filtered.measured else prior * mean(loads)
            if kind == "DRIVE":
                row[i] *= abs(sides[0])
            if kind == "DELAY":
                first, second = (mean(of) for of in derivatives)
                row[i] = -prior * filtered.gain * (first + self.delay / 2 * second)
            if i in errors and self.known and not filtered.measured:
                row[i] = self.sigma * mean(errors[i][0]) + mean(errors[i][1])
        return row

    def deform(self, k: int, at: int) -> None:
        phi = self.inputs.phi
        change = phi[k] - phi[k - 1] if at else 0.0
        least = min(resolution(self.p[f"encoder.{name}"]) for name in ("theta", "q")) / 4
        self.phi_min, self.phi_max = min(self.phi_min, phi[k]), max(self.phi_max, phi[k])
        self.resting = 0 if abs(change) > least else self.resting + 1

    def torque(self, k: int) -> float:
        of = [i for i, kind in enumerate(self.kinds) if kind in TORQUE]
        return float(self.inputs.F[k, of] @ self.beta[of] + self.inputs.nominal[k])

    # Outputs

    def set_beta(self) -> None:
        self.beta = np.zeros(self.n, dtype=np.longdouble)
        self.beta[self.live.chosen] = self.live.weighted()[0][:, 1]

    def report(self, k: int, y: float, settled: bool) -> None:
        p = self.p
        beta, P = self.live.weighted()
        dF = self.inputs.dF[k, self.live.chosen]
        self.sigma = float(dF @ beta[:, 1] + self.inputs.nominal_slope[k])
        by_gain, variance = float(dF @ beta[:, 0]), float(dF @ P @ dF)
        self.known = math.sqrt(variance) < 0.2 * self.sigma
        of: dict[str, float] = {}
        for i, (kind, index, prior) in enumerate(self.columns):
            scale = self.inputs.l[k] ** index if kind == "DAMPING" else 1.0
            of[kind] = of.get(kind, 0.0) + float(self.beta[i]) * prior * scale
        delay = of.get("DELAY", 0.0)
        self.delay = min(max(delay, -3 * p["prior.delay"]), 3 * p["prior.delay"])
        K_0 = p["prior.tau_e"] / p["range.phi"]
        eccentric = math.hypot(of.get("SIN_Q", 0.0), of.get("COS_Q", 0.0))
        of_spring = [kind in TORQUE for kind, _, _ in self.columns]
        F = np.where(of_spring, self.inputs.F[k], 0.0)[self.live.chosen]
        attenuation = self.rounding * self.live.weight * variance
        values = {
            "tau_e_std": math.sqrt(
                float(F @ P @ F)
                + (p["prior.torque_gain"] * float(F @ beta[:, 0])) ** 2
                + (attenuation * self.torque(k)) ** 2
            ),
            "sigma": self.sigma,
            "sigma_std": math.sqrt(
                variance + (p["prior.torque_gain"] * by_gain) ** 2 + (attenuation * self.sigma) ** 2
            ),
            "sigma_per_gain": by_gain / abs(self.sigma) if self.sigma else 0.0,
            "tau_e": self.torque(k),
            "tau_e_residual": y,
            "epsilon": self.epsilon,
            "rho": self.rho,
            "a": float(settled),
            "eta": self.curve(of.get("NOMINAL", 0.0)),
            "D_theta_hat": p["motor.D_theta"] * (1 + of.get("VISCOUS", 0.0)),
            "B_hat": p["motor.B"] * (1 + of.get("INERTIA", 0.0)),
            "tau_coulomb_hat": of.get("COULOMB", 0.0),
            "misfit": math.sqrt(max(1.0, self.q)),
            "bias_hat": of.get("BIAS", 0.0),
            "damping_hat": of.get("DAMPING", 0.0),
            "load_friction_hat": of.get("LOAD", 0.0) + of.get("DRIVE", 0.0),
            "eccentric_hat": eccentric / K_0 if K_0 else 0.0,
            "delay_hat": delay,
            "hysteresis_hat": of.get("HYSTERESIS", 0.0),
        }
        for name, value in values.items():
            self.out.setdefault(name, []).append(value)

    def curve(self, error: float) -> Array:
        """Coefficients of setPoint^j phi^e [size: 8 x 5]."""
        n, eta = self.p["rls.n"], np.zeros((8, 5))
        if self.eta_0 is not None:
            eta[: self.eta_0.shape[0], : self.eta_0.shape[1]] = (1 + error) * self.eta_0
        for i, (kind, index, prior) in enumerate(self.columns):
            places = {
                "POWER": (index % n, index // n),
                "HIGHER_POWER": (n + index, 0),
                "SET_POWER": (0 if self.p["rls.symmetric"] else 1, self.p["rls.m"]),
            }
            if kind in places:
                number, j = places[kind]
                e = self.inputs.exponent(number)
                unit = self.p["range.phi"] ** e * self.p["range.setPoint"] ** j * max(e, 1)
                eta[number, j] += float(self.beta[i]) * prior / unit
        return eta
