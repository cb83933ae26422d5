"""FilteredRegression in numpy, written from the headers in c/filtered_regression/, with dense
matrices in extended precision.

This code shares nothing with the C code except the direction of motion, which has its own tests.
"""

import math
from collections import defaultdict
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from c_library import Array, Library
from dense_change import Change
from dense_gate import accepted
from dense_signals import (
    CURVE,
    GAPS,
    GROUPS,
    PLAYS,
    SENSOR,
    TORQUE,
    Filtered,
    Inputs,
    Parameters,
    as_if_smooth,
    bandwidth,
    decimation,
    place_of_knee,
    resolution,
    through,
)
from oracle import DEFAULTS, solve

Long = NDArray[np.longdouble]
SIDES = 2
LEAST = 1e-9
START: Parameters = {  # start values, with rls.n for the AwAS and an unknown inertia
    **DEFAULTS,
    **{"method": 2, "torque.held": 0, "rls.n": 3, "range.phi": 0.3, "range.setPoint": 100.0},
    **{"range.knee": 0.0, "range.knee_2": 0.0, "range.setPoint_center": 0.0},
    **{"regression.bandwidth": 350.0, "regression.slow": 0.05, "regression.drift": 0.0},
    **{"regression.memory": 7.0, "prior.tau_e": 45.0, "prior.nominal": 0.0, "prior.D_theta": 0.2},
    **{"prior.B": 0.1, "prior.tau_coulomb": 0.02, "prior.torque_gain": 0.02, "prior.bias": 0.05},
    **{"prior.damping": 7.5e-3, "prior.load_friction": 0.1, "prior.eccentric": 5e-4},
    **{"prior.delay": 2e-3, "prior.reversal": 2e-3, "prior.power": 1.0, "prior.gap": 0.02},
    **{"prior.hysteresis": 0.01, "prior.eccentric_motor": 1e-4},
}
FRICTION = ("LOAD", "DRIVE", "VISCOUS", "COULOMB")


def identity(n: int) -> Long:
    return np.eye(n, dtype=np.longdouble)


def inverse(matrix: Long) -> Long:
    """Inverse of a positive definite matrix."""
    return solve(matrix, identity(len(matrix)))


class Information:
    """sum w r r' over rows r = (x, u, y) of `size` columns x and two right-hand sides."""

    def __init__(self, size: int, precision: float, least: float | None = None) -> None:
        self.size, self.least = size, precision if least is None else least
        self.matrix: Long = np.diag(np.r_[np.full(size, precision), 0, 0]).astype(np.longdouble)

    def take(self, row: Long, w: float) -> None:
        self.matrix += w * np.outer(row, row)

    def factors(self) -> tuple[Long, Long, np.longdouble]:
        """Returns rows (U, U z) [size: size x size + 2], D, and residual, by elimination."""
        left, size = self.matrix.copy(), self.size
        rows: Long = np.zeros((size, len(left)), dtype=np.longdouble)
        D: Long = np.zeros(size, dtype=np.longdouble)
        for i in range(size):
            D[i] = left[i, i]
            rows[i, i:] = left[i, i:] / D[i]
            left[i:, i:] -= D[i] * np.outer(rows[i, i:], rows[i, i:])
        return rows, D, left[-1, -1]

    def fade(self, keep: float) -> None:
        """No entry of D falls below the least one."""
        rows, D, rest = self.factors()
        self.multiply(rows, np.maximum(D * keep, self.least), rest * keep)

    def restart(self, count: int, precision: float) -> None:
        """Resets the information about the first parameters to this precision."""
        rows, D, rest = self.factors()
        rows[:count] = np.eye(self.size, len(self.matrix))[:count]
        D[:count] = precision
        self.multiply(rows, D, rest)

    def multiply(self, rows: Long, D: Long, rest: np.longdouble) -> None:
        self.matrix = (rows.T * D) @ rows
        self.matrix[-1, -1] += rest

    def walk_sample(self, v: Long, c: float) -> tuple[Long, float]:
        """Returns a row and its weight that add c v v' to the inverse of the information."""
        g = self.matrix[:, : self.size] @ v
        return g, -c / (1 + c * float(v @ g[: self.size]))

    def walk(self, v: Long, c: float) -> None:
        self.take(*self.walk_sample(v, c))

    def squares(self, beta: Long) -> float:
        """Weighted sum of squares of y - x' beta."""
        error = np.concatenate([beta, [0, -1]])
        return float(error @ self.matrix @ error)

    @property
    def rest(self) -> float:
        """Its least value."""
        return float(self.factors()[2])


class Posterior:
    """Prior and data of some columns: covariance P and estimates of both sides."""

    def __init__(self, chosen: list[int], weight: float, prior_B: float, drive: int) -> None:
        self.prior_B, self.chosen, self.weight = prior_B, chosen, weight
        self.drive = chosen.index(drive) if drive in chosen else -1
        self.of_drive = np.zeros(2)  # noise in its column: information, and by the gain
        self.surplus = self.removed = self.spread = 0.0
        self.P = identity(len(chosen))
        self.beta: Long = np.zeros((len(chosen), SIDES), dtype=np.longdouble)

    def sums(self, data: Information) -> tuple[Long, Long]:
        """Prior and data: information matrix, and right-hand sides."""
        n, own = len(self.chosen), [*self.chosen, data.size, data.size + 1]
        matrix: Long = self.weight * data.matrix[np.ix_(own, own)]
        return matrix[:n, :n] + identity(n), matrix[:n, n:]

    def solve(self, data: Information) -> None:
        matrix, right = self.sums(data)
        self.P = inverse(matrix)
        self.beta = self.P @ right

    def learn(self, row: Long, w: float) -> float:
        """Returns the variance of the prediction of y divided by the variance of the sample."""
        x, sides = row[self.chosen], row[-SIDES:]
        w = w * self.weight
        Px = self.P @ x
        rho = x @ Px * w
        self.beta = self.beta + np.outer(Px, sides - x @ self.beta) * (w / (1 + rho))
        self.P = self.P - np.outer(Px, Px) * (w / (1 + rho))
        return float(rho)

    def subtract(self, i: int, information: float, right: Any) -> None:
        """Subtracts information about a coefficient, and its right-hand sides."""
        gain = 1 / (1 - information * self.P[i, i])
        along = self.P[:, i].copy()
        self.beta = self.beta + gain * np.outer(along, information * self.beta[i] - right)
        self.P = self.P + information * gain * np.outer(along, along)

    def remove(self, information: float) -> None:
        """Removes false information about b by rounding of theta, but keeps the prior."""
        self.surplus += information
        back = min(self.surplus, float(1 / self.P[-1, -1] - 1))
        if back > 0:
            self.subtract(-1, back, np.array([0, -back / self.prior_B]))
            self.surplus -= back
            self.removed += back

    def remove_noise(self) -> None:
        """Removes the noise of the torque from the column of the torque."""
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
        self.subtract(i, D - 1 - left * share, np.array([by_gain, 0]) + (1 - share) * sides)

    def weighted(self) -> tuple[Long, Long]:
        """Estimates and covariance with the weight of the data about b after the removal."""
        if self.removed <= 0:
            return self.beta, self.P
        of_b = max(1 / self.P[-1, -1] - 1, 0)
        unsure = (0.05 / self.prior_B * self.removed) ** 2
        share = of_b / (of_b + self.removed + self.spread + unsure)
        variance = 1 / (1 + of_b * share)
        along = self.P[:, -1] / self.P[-1, -1]
        mean = self.beta[-1] / self.P[-1, -1] * share * variance
        beta = self.beta + np.outer(along, mean - self.beta[-1])
        return beta, self.P + np.outer(along, along) * (variance - self.P[-1, -1])


class Blocks:
    """Blocks of rows, 50 ms, under a smooth window."""

    def __init__(self, n: int, w: float, T: float, K: int) -> None:
        self.length = max(math.floor(0.05 / (K * T) + 0.5), 4)
        x = (np.arange(self.length) + 0.5) / self.length
        self.window = 16 * (x * (1 - x)) ** 2
        h = np.append(np.repeat(self.window, K), np.zeros(math.ceil(30 / (w * T))))
        filtered = [through(np.append(0.0, h), order, w, T) for order in (0, 2)]
        self.energy, self.energy_second = (float(np.sum(f**2) / np.sum(h**2)) for f in filtered)
        self.all, self.walking = (Information(n, 1.0, LEAST) for _ in range(2))
        self.prior = 1.0  # share of it that is left in both
        self.count = self.gained = 0.0
        self.past = 0.0  # as count, with the forgotten ones
        self.rows: list[tuple[Long, float, float, float]] = []  # row, weight, factor, roughness


def threshold(N: float) -> float:
    return N + 3 * math.sqrt(2 * N)


class Oracle:
    """The estimator; `run` gives all outputs of all ticks."""

    def __init__(self, c: Library, p: Parameters, z: Array, modality: Array) -> None:
        self.c, self.p, self.z, self.modality = c, p, z, modality
        self.T, self.w, self.K = p["samplePeriod"], bandwidth(p), decimation(p)
        self.good = accepted(p, z, modality)
        self.runs = self.find_runs(self.good)
        self.inputs = Inputs(p, np.nan_to_num(z, posinf=0.0, neginf=0.0), self.runs)
        self.columns = self.inputs.columns
        self.n = len(self.columns)
        self.kinds = [kind for kind, _, _ in self.columns]
        self.of_spring = np.array([kind in TORQUE for kind in self.kinds])
        self.groups = [GROUPS.get(kind, 0) for kind in self.kinds]
        self.counts = np.array([resolution(p[f"encoder.{name}"]) for name in ("theta", "q")])
        self.phi_min, self.phi_max = math.inf, -math.inf
        self.resting = self.unsure = 0
        self.settling, self.is_start = 0.0, True
        self.rough = 0.0
        self.out: dict[str, list[Any]] = defaultdict(list)
        self.set_noise()
        self.start_learning()

    def start_learning(self) -> None:
        """All that a row changes."""
        n = self.n
        self.data = Information(n, LEAST)
        self.used = [1, 0, 0, 0, 0, 0, 0]
        self.live = self.posterior(0, 1.0)
        self.blocks = Blocks(n, self.w, self.T, self.K)
        self.full = np.zeros(0, np.longdouble), 1.0, 0.0  # mean, variance and count of a full block
        self.q = self.factor = 1.0
        self.surplus = self.spread = self.weights = 0.0
        self.of_drive = np.zeros(2)
        self.trial = self.last_trial = 0
        self.since = self.pause = self.epsilon = self.rho = 0.0
        self.samples: list[int] = []  # of the next row
        # What the last row still changes, and ticks since it as far as there is something.
        self.steps, self.tick = iter(list[None]()), self.K
        self.friction_drifts = self.known = self.is_built = self.has_row = False
        self.new_variances = False  # whether this tick computes the variances
        self.set_beta()
        self.sigma = self.y = self.delay = 0.0
        self.interrupted = False
        self.once_used: set[int] = set()  # groups that a trial has shown to be needed
        self.change = self.hypotheses()
        self.passes = self.make_passes()
        next(self.passes)

    def learn_anew(self) -> None:
        self.is_start = False
        self.start_learning()

    def find_runs(self, good: NDArray[np.bool_]) -> list[slice]:
        """Good samples in sequence with one modality."""
        goes_on = np.zeros(len(good) + 1, dtype=bool)
        goes_on[1:-1] = good[:-1] & good[1:] & (np.diff(self.modality) == 0)
        begins, ends = np.flatnonzero(good & ~goes_on[:-1]), np.flatnonzero(good & ~goes_on[1:])
        return [slice(begin, end + 1) for begin, end in zip(begins, ends, strict=True)]

    def set_noise(self) -> None:
        """Noise behind the filter: of torque [(N.m)2], of theta per variance [(N.m/rad)2]."""
        p, K = self.p, self.K
        pulse = np.concatenate([[0.0], np.full(K, 1 / K), np.zeros(20000)])
        response = [through(pulse, order, self.w, self.T) for order in (0, 2)]
        self.gain, gain_second = (float(np.sum(of**2)) for of in response)
        self.of_torque = (p["motor.gamma"] * p["noise.tau"]) ** 2
        self.of_theta = (p["motor.gamma"] ** 2 * p["motor.B"]) ** 2
        self.torque_noise, self.inertial = self.gain * self.of_torque, gain_second * self.of_theta

    def hypotheses(self) -> Change:
        self.waiting: tuple[Long, float] | None = None  # process noise of friction
        self.is_sampled = False  # the first half of a step of the hypothesis of other friction
        friction = [i for i, kind in enumerate(self.kinds) if kind in FRICTION]
        first = friction[0] if friction else 0
        springs = int(np.count_nonzero(self.of_spring))
        bias = self.kinds.index("BIAS") if "BIAS" in self.kinds else None
        return Change(self.blocks.all, springs, bias, slice(first, first + len(friction)))

    # Columns of a posterior

    def is_distinct(self, i: int) -> bool:
        kind, index, _ = self.columns[i]
        covered = (self.phi_max - self.phi_min) / 4 / self.p["range.phi"]
        widths = {"DEAD_ZONE": GAPS, "HYSTERESIS": PLAYS}.get(kind)
        return widths is None or widths[index] < covered

    def posterior(self, trial: int, weight: float) -> Posterior:
        """Posterior of the used columns, followed by the columns of the tried group."""
        tried = [0 < group == trial for group in self.groups]
        own = [i for i in range(self.n) if self.is_distinct(i)]
        chosen = [i for i in own if self.used[self.groups[i]] and not tried[i]]
        chosen += [i for i in own if tried[i]]
        drive = self.kinds.index("DRIVE") if "DRIVE" in self.kinds else -1
        return Posterior(chosen, weight, self.p["prior.B"], drive)

    # Passes

    def make_passes(self) -> Iterator[None]:
        """Builds posteriors from all data, one after the other, by one step in each tick."""
        while True:
            least = max(1.0, self.q)
            weight = 1 / (least if self.trial else self.factor)
            self.build = self.posterior(self.trial, weight)
            self.build.surplus = self.surplus * weight
            self.build.spread = self.spread * weight**2
            self.build.of_drive = self.of_drive * weight
            yield
            unread = self.n
            while unread > 0:
                unread -= 2 if unread - 1 > self.n // 2 else 1
                yield
            use = (self.end_build, self.use_build, self.set_beta, self.renew_variances)
            trial = (self.end_trial, *[lambda: None] * 3)
            judge = (self.judge, self.plan)
            for step in (*(trial if self.trial else use), *judge):
                step()
                yield
            for half in range(0 if self.trial else 4):
                yield from self.watch_friction(self.since, half)
            if not self.trial:
                self.forget(self.since)
                self.since = 0.0
                yield
            while self.pause < self.shortest_pause():
                yield

    def shortest_pause(self) -> float:
        count = self.blocks.count
        block = self.blocks.length * self.K * self.T
        return 0.2 if count < 15 else 0.0101 * block * count

    def end_build(self) -> None:
        """Removes the noise of a new posterior, which takes more rows before its first use."""
        self.build.solve(self.data)
        if self.p["prior.B"] > 0:
            self.build.remove(0.0)
        self.build.remove_noise()
        self.is_built = True

    def use_build(self) -> None:
        self.live = self.build
        self.build = Posterior([], 1.0, 0.0, -1)  # until the next pass starts
        self.is_built = False
        _, self.P = self.live.weighted()

    def renew_variances(self) -> None:
        self.new_variances = True

    def end_trial(self) -> None:
        own = sum(self.groups[i] != self.trial for i in self.build.chosen)
        gain = self.evidence(len(self.build.chosen)) - self.evidence(own)
        N, used = self.blocks.count, self.used[self.trial]
        per_block = 0.01 if self.trial == 3 else 0.05  # 3: possible knees
        limit = per_block * N
        self.used[self.trial] = 1 if gain > 3 + limit else 0 if gain < limit / 2 else used
        if self.used[self.trial]:
            self.once_used.add(self.trial)

    def evidence(self, first: int) -> float:
        """Logarithm of the evidence of the first columns, but for a constant."""
        matrix, sides = self.build.sums(self.data)
        A, right = matrix[:first, :first], sides[:first, 1]
        _, log_determinant = np.linalg.slogdet(A.astype(float))
        return float((right @ inverse(A) @ right - log_determinant) / 2)

    def has_many_blocks(self) -> bool:
        return len(self.live.chosen) < self.blocks.count

    def judge(self) -> None:
        """The misfit of the blocks."""
        blocks, N = self.blocks, self.blocks.count
        if N <= 0:
            return
        sums = blocks.walking if self.friction_drifts else blocks.all
        squares = sums.squares(self.beta) - blocks.prior * float(self.beta @ self.beta)
        self.q = squares / (N - len(self.live.chosen) / 2 if self.has_many_blocks() else N)
        self.factor = 1.0
        if self.p["regression.memory"] > 0:
            self.factor = max(1.0, self.q)
            t = threshold(N) / N
            if self.q > t:
                self.factor = max(self.factor, 1 + (self.q - t) * max(1, N / 5))

    def plan(self) -> None:
        """After each pass, the next group is tried if the group has columns."""
        self.pause = 0.0
        was_trial, self.trial = self.trial != 0, 0
        if was_trial or self.blocks.count < 15:
            return
        number = len(self.used) - 1
        following = [(self.last_trial + k) % number + 1 for k in range(number)]
        ready = {group for i, group in enumerate(self.groups) if self.is_distinct(i)}
        self.trial = next((group for group in following if group in ready), 0)
        self.last_trial = self.trial or self.last_trial

    def watch_friction(self, time: float, step: int) -> Iterator[None]:
        """Step 0 and 1: the blocks, of viscous and Coulomb friction; 2 and 3: the data. Each update
        takes two ticks, and a row may arrive between the two ticks.
        """
        blocks, N = self.blocks, self.blocks.count
        kind = ("VISCOUS", "COULOMB")[step % 2]
        sums = blocks.walking if step < 2 else self.data
        self.waiting = None
        if kind in self.kinds and (step < 2 or self.friction_drifts):
            v = identity(self.n)[self.kinds.index(kind)]
            self.waiting = sums.walk_sample(v, 1e-3 * time)
        yield
        if self.waiting is not None:
            sums.take(*self.waiting)
        if step == 1 and 2 * self.n < N and self.change.friction_blocks == 0:
            constant, walking = blocks.all.rest, blocks.walking.rest
            if walking < 0.8 * constant and constant > (N - self.n) * threshold(N) / N:
                self.friction_drifts = True
            elif walking > 0.95 * constant:
                self.friction_drifts = False
        yield

    def forget(self, time: float) -> None:
        blocks, memory, drift = self.blocks, self.p["regression.memory"], self.p["regression.drift"]
        gained, blocks.gained = blocks.gained, 0.0
        everything = (self.data, blocks.all, blocks.walking)
        if self.factor > 1.5 and self.has_many_blocks():
            sudden = min(math.sqrt(max(1.0, self.q)) / self.change.usual_misfit / 3, 10.0)
            keep = math.exp(-gained * max(sudden, 1.0) / memory)
            for sums in everything:
                sums.fade(keep)
            blocks.prior *= keep
            blocks.count *= keep
            self.surplus *= keep
            self.spread *= keep**2
            self.of_drive *= keep
            self.weights *= keep
        v = np.where([kind in CURVE for kind in self.kinds], self.before[: self.n], 0)
        power = v @ v
        if drift > 0 and power > 0:
            variance = drift * time / (power + self.R)
            self.weights /= 1 + variance * float(v @ self.data.matrix[: self.n, : self.n] @ v)
            for sums in everything:
                sums.walk(v, variance)

    # Rows

    def friction_variance(self, unknown: float) -> float:
        if "COULOMB" not in self.kinds or unknown == 0:
            return 0.0
        C = self.kinds.index("COULOMB")
        own = self.live.chosen.index(C)
        variance = float(self.beta[C] ** 2 + self.P[own, own])
        largest = self.p["motor.gamma"] * self.p["prior.tau_coulomb"] * unknown
        return float(largest**2 * variance)

    def noise_of_row(self, filtered: Filtered, unknown: float) -> tuple[float, float, float]:
        """Returns R, the factor of R by errors that do not average out, and lambda."""
        p, rounding = self.p, self.sigma**2 * float(np.sum(self.counts**2)) / 12
        stays, share = rounding * self.resting, 0.0
        if filtered.measured:
            R = rounding + p["noise.tau_e"] ** 2
        else:
            friction = self.friction_variance(unknown)
            rounded = self.torque_noise + self.inertial * self.counts[0] ** 2 / 12
            whole = max(rounded, self.torque_noise + self.inertial * self.rough)
            share = self.torque_noise / (whole + friction)
            R = (rounding + self.of_torque) * (1 + 0.3 * (whole / rounded - 1))
            R += friction * 16 / (3 * self.w * self.T)
            stays += friction * self.unsure
        last = (1 + stays / R) ** 2
        return float(R * last / self.K), float(last), float(share)

    def learn(self, k: int, filtered: Filtered, row: Long, rough: Array) -> None:
        at = k - filtered.run.start
        R, last, share = self.noise_of_row(filtered, filtered.unknown_f[at])
        self.R, self.before = R, row
        self.weights += 1 / R
        if "DRIVE" in self.kinds and not filtered.measured and row[-SIDES] != 0:
            self.remove_noise(row, share, R)
        self.has_row = True
        self.epsilon = self.error(row)
        self.rho = self.live.learn(row, 1 / R)
        mean_rough = float(np.mean(rough[self.samples]))
        prior_B = self.p["prior.B"]
        if prior_B > 0:
            inertial = 0.0 if filtered.measured else self.inertial
            theta = self.z[filtered.run, 0]
            moved = np.mean([i > 0 and theta[i] != theta[i - 1] for i in self.samples])
            V = mean_rough + 0.056 * moved * self.counts[0] ** 2 / 12
            N = inertial * prior_B**2 * V / R
            Q = 6 * (N / prior_B) ** 2
            self.surplus += N
            self.spread += Q
            for posterior in (self.live, self.build):
                posterior.spread += Q * posterior.weight**2
            self.build.surplus += N * self.build.weight
            self.live.remove(N * self.live.weight)
        self.steps, self.tick = self.make_steps(row, R, last, mean_rough, filtered.measured), 0
        self.interrupted = False

    def make_steps(
        self, row: Long, R: float, last: float, rough: float, measured: bool
    ) -> Iterator[None]:
        """Makes the seven steps after a row, distributed over the ticks until the next row."""
        self.set_beta()
        yield
        self.new_variances = True
        yield
        self.since += self.K * self.T
        self.pause += self.K * self.T
        self.data.take(row, 1 / R)
        yield
        if self.is_built:
            self.build.learn(row, 1 / R)
        yield
        blocks = self.blocks
        was_full = len(blocks.rows) == blocks.length
        if was_full:
            self.end_block(*self.full, measured)
        if not self.interrupted:
            blocks.rows.append((row, 1 / R, last, rough))
        is_full = len(blocks.rows) == blocks.length
        if is_full:
            self.full = mean, variance, _ = self.full_block(measured)
            self.change.take(mean, variance, blocks, self.friction_drifts, self.beta)
        elif not was_full:
            self.pass_on(0)
        yield
        for step, sums in enumerate((blocks.all, blocks.walking), 1):
            if is_full:
                sums.take(mean, 1 / variance)
            else:
                self.pass_on(step)
            yield

    def pass_on(self, step: int) -> None:
        """Makes a step of the refit, except while friction gets the variances of its priors."""
        if self.change.left > 0:
            self.change.left -= step == 1 and self.is_sampled
            self.is_sampled = step == 0
            return
        by_time = min(self.K * self.T / 0.0065, self.K - 1, 4)
        for _ in range(int(max(by_time, 1))):
            next(self.passes)

    def end_block(self, mean: Long, variance: float, count: float, measured: bool) -> None:
        """After the row behind the block."""
        blocks = self.blocks
        blocks.count += count
        blocks.past += count
        blocks.gained += count * blocks.length * self.K * self.T
        if self.p["regression.memory"] > 0:
            misfit = math.sqrt(max(1.0, self.q))
            if self.change.judge(misfit, blocks, self.friction_drifts, measured, self.beta):
                self.waiting = None  # a sample of the sums as they were
                self.friction_drifts = False
        blocks.rows.clear()

    def follow(self) -> None:
        """Work of a tick without a new row."""
        ticks = max(self.K - 1, 1)
        if self.tick < ticks:
            first, end = (math.ceil(7 * tick / ticks) for tick in (self.tick, self.tick + 1))
            for _ in range(first, end):
                next(self.steps)
            self.tick += 1

    def full_block(self, measured: bool) -> tuple[Long, float, float]:
        """Mean row, its variance, and as how many independent blocks it counts."""
        blocks, h = self.blocks, self.blocks.window
        w, last, rough = np.array([entry[1:] for entry in blocks.rows]).T
        mean = (h * w) @ np.array([entry[0] for entry in blocks.rows]) / (h @ w)
        variance = (h**2 @ w) / (h @ w) ** 2 * blocks.energy
        if not measured:
            V = self.of_theta * np.mean(rough)
            variance += V * blocks.energy_second * np.sum(h**2) / (self.K * np.sum(h) ** 2)
        return mean, float(variance), float(np.sum(h**2 / last) / np.sum(h**2))

    def error(self, row: Long) -> float:
        return float(row[-1] - row[:-SIDES] @ self.beta)

    def remove_noise(self, row: Long, share: float, R: float) -> None:
        """Removes the noise of the torque, which y also contains, from the column of the torque."""
        i, torque = self.kinds.index("DRIVE"), row[-SIDES]
        slope = row[i] / torque
        returned = np.clip(slope * self.beta[i], -0.5, 0.5)
        row[i] *= abs(1 - share * self.error(row) / (1 - share * returned) / torque)
        of_drive = (1 - share) * self.torque_noise * slope * np.array([slope, 1]) / R
        self.of_drive += of_drive.astype(float)
        self.build.of_drive += of_drive.astype(float) * self.build.weight

    def was_moving(self, theta: Array) -> bool:
        """Whether the positions since the first sample exclude that the motor was at rest then.

        From rest, a motor covers at most a quarter of its way in the first half of the time.
        """
        k = len(theta) - 1
        if k < 2 or k & (k - 1):
            return False
        half, way = np.abs(theta[[k // 2, k]] - theta[0])
        resolution = max(self.counts[0], 5 * math.sqrt(self.rough))
        if half < 0.3 * way - resolution:
            self.is_start = False
        return bool(half > 0.3 * way + resolution)

    def wait_until_settled(self) -> None:
        """A block that is not full would contain rows from both sides of the gap."""
        self.settling = 12 / self.w
        self.interrupted = True
        if len(self.blocks.rows) < self.blocks.length:
            self.blocks.rows.clear()

    def mean_row(self, filtered: Filtered, loads: Array) -> Long:
        """Signals of the samples. Signals that depend on the estimate use the present estimate."""

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
                first, second = (mean(of) for of in filtered.derivatives)
                row[i] = -prior * filtered.gain * (first + self.delay / 2 * second)
            if i in filtered.encoder_errors and self.known and not filtered.measured:
                angle, motor = map(mean, filtered.encoder_errors[i])
                row[i] = self.sigma * angle + motor
        return row

    # Samples

    def run(self) -> dict[str, Array]:
        for number, run in enumerate(self.runs):
            if number:
                if self.is_start:
                    self.learn_anew()
                self.wait_until_settled()
                self.samples.clear()
            measured = self.modality[run.start] == SENSOR
            self.go(Filtered(self.c, self.p, self.inputs, self.z, run, measured))
        return {name: np.array(values, dtype=np.float64) for name, values in self.out.items()}

    def go(self, filtered: Filtered) -> None:
        run = filtered.run
        theta = np.concatenate([np.full(4, self.z[run.start, 0]), self.z[run, 0]])
        rough = np.convolve(theta, [1, -4, 6, -4, 1], "valid") ** 2 / 70
        smooth, state, loads = as_if_smooth(self.w, self.T), np.zeros(3), np.zeros(len(rough))
        for at, k in enumerate(range(run.start, run.stop)):
            self.deform(k, at)
            if at:
                self.unsure = self.unsure + 1 if filtered.unknown[at] > 0 else 0
                tau_e = self.torque(k) if self.known else self.y
                mean = [-abs(tau_e) * filtered.sign[at]]
                loads[at : at + 1], state = lfilter(*smooth, mean, zi=state)
            if filtered.measured or at > 12 / (self.w * self.T) + 1:
                self.is_start = False
            if self.is_start and self.was_moving(self.z[run, 0][: at + 1]):
                self.learn_anew()
                self.wait_until_settled()
            self.settling = max(self.settling - self.T, 0)
            settled, complete = self.settling <= 0, False
            if settled:
                if not filtered.measured:
                    self.rough += min(self.T / 0.1, 1) * (rough[at] - self.rough)
                self.samples.append(at)
                complete = len(self.samples) == self.K
            if complete:
                self.learn(k, filtered, self.mean_row(filtered, loads), rough)
                self.samples.clear()
            if not complete or self.K == 1:
                self.follow()
            if not settled:
                self.epsilon = self.rho = 0.0
            self.new_variances |= not complete and not (settled and self.has_row)
            self.report(k, filtered.y[at], settled)
            self.y = float(filtered.y[at]) - self.epsilon

    def deform(self, k: int, at: int) -> None:
        phi = self.inputs.phi
        change = phi[k] - phi[k - 1] if at else 0.0
        self.phi_min, self.phi_max = min(self.phi_min, phi[k]), max(self.phi_max, phi[k])
        self.resting = 0 if abs(change) > min(self.counts) / 4 else self.resting + 1

    def torque(self, k: int) -> float:
        return float(self.inputs.F[k] @ self.spring[1] + self.inputs.nominal[k])

    # Outputs

    def set_beta(self) -> None:
        """Estimates for both right-hand sides, gain and y; stored until the posterior changes."""
        estimates, self.P = self.live.weighted()
        self.by_gain, self.beta = np.zeros((SIDES, self.n), dtype=np.longdouble)
        self.by_gain[self.live.chosen], self.beta[self.live.chosen] = estimates.T
        self.spring = np.where(self.of_spring, [self.by_gain, self.beta], 0)
        self.of: dict[str, float] = defaultdict(float)
        self.new_coefficients = True
        for beta, (kind, _, prior) in zip(self.beta, self.columns, strict=True):
            self.of[kind] += float(beta) * prior
        self.eta = self.curve()

    def judge_knees(self, k: int) -> tuple[Array, float]:
        """Slopes of the columns, and variance of the stiffness beside a place where it changes."""
        dF, x, variance = self.inputs.dF[k].copy(), self.inputs.x[k], 0.0
        place = abs(x) if self.p["rls.symmetric"] else x
        for i, (kind, index, prior) in enumerate(self.columns):
            jump = float(self.beta[i]) * prior / self.p["range.phi"]
            if kind in ("KNEE", "POSSIBLE_KNEE"):
                variance += (jump / 2) ** 2 * (abs(place - place_of_knee(self.p, index)) < 0.02)
            elif (kind, index) == ("DEAD_ZONE", 2):
                jump, others = jump / GAPS[2], np.arange(self.n) != i
                outside = float(dF[others] @ self.beta[others]) + self.inputs.nominal_slope[k]
                if outside + jump < 0.3 * outside:
                    dF[i] = 0.0
                elif GAPS[2] / 2 < abs(x) < 2 * GAPS[2]:
                    variance += (jump / 2) ** 2
        return dF, variance

    def report(self, k: int, y: float, settled: bool) -> None:
        p, of, chosen = self.p, self.of, self.live.chosen
        dF, knees = self.judge_knees(k)
        F = np.where(self.of_spring, self.inputs.F[k], 0.0)
        self.sigma = float(dF @ self.beta + self.inputs.nominal_slope[k])
        tau_e, by_gain = self.torque(k), float(dF @ self.by_gain)
        if self.new_variances:
            variance, of_tau_e = (float(f[chosen] @ self.P @ f[chosen]) for f in (dF, F))
            self.variances, self.new_variances = (variance, of_tau_e), False
        variance, of_tau_e = self.variances
        self.known = math.sqrt(variance) < 0.2 * self.sigma
        if self.new_coefficients:
            self.of["TURNING"] = math.hypot(of["SIN_Q"], of["COS_Q"])
            if of["TURNING"]:
                of["TURNING"] /= max(abs(self.sigma), of["TURNING"])
            of["DAMPING"] = sum(
                float(beta) * prior * self.inputs.l[k] ** index
                for beta, (kind, index, prior) in zip(self.beta, self.columns, strict=True)
                if kind == "DAMPING"
            )
            self.new_coefficients = False
        longest = 3 * p["prior.delay"]
        self.delay = min(max(of["DELAY"], -longest), longest)
        attenuation = self.weights * self.live.weight * variance
        rounding = self.gain * float(np.sum(self.counts**2)) / 12
        harmonics = (0.035 * p["prior.eccentric"]) ** 2

        def std(variance: float, by_gain: float, value: float) -> float:
            own, value = math.sqrt(variance), attenuation * abs(value)
            pull = min(harmonics * value, 2 * own)
            return math.hypot(own, p["prior.torque_gain"] * by_gain, rounding * value, pull)

        values = {
            "tau_e_std": std(of_tau_e, float(F @ self.by_gain), tau_e),
            "sigma": self.sigma,
            "sigma_std": math.hypot(std(variance, by_gain, self.sigma), math.sqrt(knees)),
            "sigma_per_gain": by_gain / abs(self.sigma) if self.sigma else 0.0,
            "tau_e": tau_e,
            "tau_e_residual": y,
            "epsilon": self.epsilon,
            "rho": self.rho,
            "a": float(settled),
            "eta": self.eta,
            "D_theta_hat": p["motor.D_theta"] * (1 + of["VISCOUS"]),
            "B_hat": p["motor.B"] * (1 + of["INERTIA"]),
            "tau_coulomb_hat": of["COULOMB"],
            "misfit": math.sqrt(max(1.0, self.q)),
            "bias_hat": of["BIAS"],
            "damping_hat": of["DAMPING"],
            "load_friction_hat": of["LOAD"] + of["DRIVE"],
            "eccentric_hat": of["TURNING"],
            "delay_hat": of["DELAY"],
            "hysteresis_hat": of["HYSTERESIS"],
        }
        for name, value in values.items():
            self.out[name].append(value)

    def curve(self) -> Array:
        """Coefficients of setPoint^j phi^e [size: 8 x 5]."""
        n = self.p["rls.n"]
        eta = (1 + self.of["NOMINAL"]) * np.array(self.p.get("rls.eta_0", np.zeros((8, 5))))
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
                power = np.poly1d([1.0, -self.p["range.setPoint_center"]]) ** j
                eta[number, : j + 1] += float(self.beta[i]) * prior / unit * power.c[::-1]
        return eta
