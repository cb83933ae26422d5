"""Placeholders, held values, jumps of counters and of clocks are found, and nothing else is."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

import foreign_joint
from checked_logs import KNEE, joint_log, knee_log, log_by_hand, log_under_gravity
from command_line import Shell
from recorded_logs import (
    Array,
    awas_log,
    configured,
    in_memory,
    plain_log,
    write_log,
)
from shared_data import data_folder
from sigmahat.checks.check import check
from sigmahat.checks.findings import Kind
from sigmahat.checks.text import sentence
from sigmahat.guess.columns import interval, read_columns
from sigmahat.guess.guess import guess
from sigmahat.recording.false_samples import false_samples, returns
from sigmahat.recording.log import LogError, LogInMemory
from sigmahat.recording.notes import (
    ClockSetBack,
    ClockStartedAgain,
    CounterReturned,
    HeldLeftOut,
    MissingSamples,
    PlaceholderLeftOut,
    RecordingNote,
)
from sigmahat.recording.readers.formats import open_log
from sigmahat.recording.sampling import sample

ROWS = 8000
TUTORIAL = Path(__file__).parents[2] / "examples" / "tutorial" / "knee.csv"


def moving(rows: int = ROWS) -> dict[str, Array]:
    """A joint that moves, with encoders of 18 bits and a noisy torque, 1 ms apart."""
    t = 1e-3 * np.arange(rows)
    step = 2 * np.pi / 2**18
    theta = 0.6 * np.sin(3 * t) + 0.2 * np.sin(11 * t)
    return {
        "t": t,
        "theta": step * np.round(theta / step),
        "q": step * np.round((theta + 0.05 * np.sin(11 * t)) / step),
        "tau": 0.3 * np.cos(3 * t)
        + 0.2 * np.cos(11 * t)
        + np.random.default_rng(1).normal(0, 2e-3, rows),
    }


def sampled(
    log: Mapping[str, Array], text: str = ""
) -> tuple[dict[str, Array], list[RecordingNote]]:
    """The values of the ports at the ticks, and the notes on them."""
    configuration = in_memory(configured() + text)
    samples = sample(LogInMemory(Path("log"), log), configuration, 1e-3)
    return dict(zip(samples.names, samples.values.T, strict=True)), list(samples.notes)


def rights() -> dict[str, Mapping[str, Array]]:
    t = 1e-3 * np.arange(ROWS)
    slow = 0.002 * np.sin(0.7 * t)  # in counts of 2 pi / 4096
    rests = np.where((t > 2) & (t < 5), 0.0, np.sin(np.pi * t))
    impacts = 0.4 * np.abs(np.sin(4 * t))  # whose velocity jumps
    log = {
        "at rest": np.zeros(ROWS),
        "rests at 0": rests,
        "slow": np.round(slow / (2 * np.pi / 4096)) * (2 * np.pi / 4096),
        "slow counts": np.round(200 * slow),
        "impacts": impacts,
        "saturated": np.clip(
            np.sin(20 * t) + np.random.default_rng(1).normal(0, 0.01, ROWS), -0.7, 0.7
        ),
        "two torques": np.where(np.sin(700 * t) > 0, 0.5, -0.5),
        "random torques": np.random.default_rng(1).choice([-1.0, -0.5, 0.0, 0.5, 1.0], ROWS),
        "noise in mA": np.round(np.random.default_rng(1).normal(0, 20, ROWS)),
        "impacts of a sensor": np.minimum(
            np.random.default_rng(1).normal(0, 0.1, ROWS)
            + 90 * np.random.default_rng(1).uniform(0, 1.5, ROWS) * (np.arange(ROWS) % 97 == 0),
            60.0,
        ),
        "coarse potentiometer": np.round(
            300 * np.sin(3 * t) + np.random.default_rng(1).normal(0, 2, ROWS)
        ),
    }
    foreign = foreign_joint.joint(False)
    return {
        "made up": log,
        "knee": knee_log(),
        "joint": joint_log(KNEE, 1e-3),
        "by hand": log_by_hand(3.0),
        "gravity": log_under_gravity(1.0),
        "awas": awas_log(1.0, 0.3),
        "plain": plain_log(),
        "moving": moving(),
        "foreign": {name: getattr(foreign, name) for name in ("theta", "q", "tau", "tau_e")},
    }


@pytest.fixture(scope="module")
def right_logs() -> dict[str, Mapping[str, Array]]:
    return rights()


def test_a_right_log_is_not_touched(right_logs: dict[str, Mapping[str, Array]]) -> None:
    found = [
        f"{log} {name}"
        for log, columns in right_logs.items()
        for name, values in columns.items()
        for is_position in (True, False)
        if false_samples(np.asarray(values, float), is_position).rows
        if not (is_position and name in TORQUES)
    ]
    assert found == []
    jumps = [
        f"{log} {name}"
        for log, columns in right_logs.items()
        for name, values in columns.items()
        if name not in TORQUES and returns(np.asarray(values, float), None) is not None
    ]
    assert jumps == []


TORQUES = ("two torques", "random torques", "noise in mA", "impacts of a sensor", "tau", "current")


def test_the_tutorial_is_not_touched() -> None:
    log = open_log(TUTORIAL)
    for name in log.columns:
        assert false_samples(log.read(name), "motor" in name or "link" in name).rows == 0


@pytest.mark.parametrize(("name", "first"), [("kr300", "kr300_a.csv"), ("desr", "desr_x00.csv")])
def test_logs_of_real_joints_are_not_touched(name: str, first: str) -> None:
    for path in sorted(data_folder(name, first).glob("*.csv")):
        log = open_log(path)
        for column in log.columns:
            assert false_samples(log.read(column), is_position=True).rows == 0, (path, column)
            assert false_samples(log.read(column), is_position=False).rows == 0, (path, column)


@pytest.mark.parametrize("value", [0.0, -1.0, 9999.0])
@pytest.mark.parametrize("share", [0.003, 0.09, 0.3])
@pytest.mark.parametrize("port", ["theta", "q", "tau"])
def test_a_placeholder_is_left_out_and_named(value: float, share: float, port: str) -> None:
    log = moving()
    rows = np.sort(
        np.random.default_rng(1).choice(np.arange(5, ROWS), round(share * ROWS), replace=False)
    )
    if port == "tau":
        rows = rows[np.append(True, np.diff(rows) > 1)]
    right = log[port].copy()
    log[port][rows] = value
    found, notes = sampled(log)
    (note,) = [each for each in notes if isinstance(each, PlaceholderLeftOut)]
    assert (note.port, note.value) == (port, value)
    assert note.row in rows + 1
    assert note.samples == pytest.approx(len(rows), rel=0.01, abs=5)
    given = np.isfinite(found[port])
    assert np.all(np.abs(found[port] - right)[given] < 0.02)
    assert np.count_nonzero(~given) <= 1.01 * len(rows) + 5


def test_rows_of_a_second_publisher_alternate_with_those_of_the_first() -> None:
    log = moving()
    for port in ("theta", "q"):
        log[port][1::2] = 0.0
    found = false_samples(log["theta"], is_position=True)
    (placeholder,) = found.placeholders
    assert placeholder.value == 0.0
    assert len(placeholder.rows) == pytest.approx(ROWS / 2, abs=10)


def test_two_placeholders_and_a_long_dropout() -> None:
    log = moving()
    log["q"][100::50] = -1.0
    log["q"][3010:3040] = 9999.0
    found = false_samples(log["q"], is_position=True)
    values = {each.value: len(each.rows) for each in found.placeholders}
    assert values[9999.0] in (29, 30)
    assert values[-1.0] == pytest.approx(len(log["q"][100::50]), abs=1)


def test_a_placeholder_of_a_counter_that_starts_again() -> None:
    """GIVEN a counter with a period, THEN its jumps from 4095 to 0 are no placeholder, and zeros
    between other values are."""
    counts = np.mod(np.round(9000 * np.sin(1e-3 * np.arange(ROWS))) + 37, 4096.0)
    assert false_samples(counts, is_position=True, wrap=4096.0).rows == 0
    counts[200::100] = 0.0
    (found,) = false_samples(counts, is_position=True, wrap=4096.0).placeholders
    assert found.value == 0.0
    assert len(found.rows) == pytest.approx(78, abs=12)


def test_a_value_held_over_a_dropout() -> None:
    log = moving()
    right = log["q"].copy()
    for first in (500, 2600, 5800):
        log["q"][first : first + 20] = log["q"][first]
    found, notes = sampled(log)
    (note,) = [each for each in notes if isinstance(each, HeldLeftOut)]
    assert (note.port, note.samples, note.row) == ("q", 57, 502)
    given = np.isfinite(found["q"])
    assert np.all(np.abs(found["q"] - right)[given] < 1e-4)


def test_a_sensor_slower_than_the_log() -> None:
    log = moving()
    right = log["q"].copy()
    log["q"] = np.repeat(log["q"][::10], 10)
    found, notes = sampled(log)
    (note,) = [each for each in notes if isinstance(each, HeldLeftOut)]
    assert note.share == pytest.approx(0.9, abs=0.01)
    given = np.isfinite(found["q"])
    assert np.mean(given) > 0.99
    assert np.all(np.abs(found["q"] - right)[given] < 1e-3)


@pytest.mark.parametrize("back_to", [0.0, 1234.0])
def test_a_counter_that_returns_is_joined(back_to: float) -> None:
    log = moving()
    step = 2 * np.pi / 2**18
    counts = np.round(log["theta"] / step)
    returned = counts.copy()
    for row in (700, 4000, 6500):
        returned[row:] -= returned[row] - back_to
    log["theta"] = step * returned
    found, notes = sampled(log)
    (note,) = [each for each in notes if isinstance(each, CounterReturned)]
    assert (note.port, note.jumps, note.row, note.period) == ("theta", 3, 701, None)
    assert np.all(np.abs(found["theta"] - step * counts) < 30 * step)


def test_a_counter_that_keeps_less_than_its_range() -> None:
    """GIVEN a counter that goes back by 32767 beyond +-32767, THEN its period is named."""
    t = 3e-3 * np.arange(4000)
    counts = np.round(60_000 * np.sin(2 * t) + 5000 * np.sin(9 * t))
    log = {**moving(4000), "t": 1e-3 * np.arange(4000)}
    log["theta"] = np.fmod(counts, 32767.0)
    log["q"] = 2 * np.pi / 65536 * counts
    text = 'ports.theta.unit = "counts"\nports.theta.counts_per_turn = 65536\n'
    configuration = in_memory(text + configured())
    checked = check(LogInMemory(Path("log"), log), configuration)
    (found,) = [each for each in checked.findings if each.kind is Kind.JUMP]
    assert found.key == "ports.theta.wrap"
    assert found.proposed == pytest.approx(32767, abs=1)
    assert "in row" in sentence(found)
    theta = sample(LogInMemory(Path("log"), log), configuration, 1e-3).values[:, 0]
    assert np.all(np.abs(theta - log["q"]) < 1e-2)


def test_a_step_over_a_gap_is_no_jump() -> None:
    log = moving()
    kept = np.r_[0:2000, 4000:ROWS]
    _, notes = sampled({name: values[kept] for name, values in log.items()})
    assert not [each for each in notes if isinstance(each, CounterReturned)]


def test_check_names_column_share_row_and_remedy() -> None:
    log = moving()
    log["theta"][49::20] = 0.0
    checked = check(LogInMemory(Path("log"), log), in_memory(configured()))
    (found,) = [each for each in checked.findings if each.kind is Kind.PLACEHOLDER]
    words = sentence(found)
    assert words.startswith("ports.theta.column: 4.99 % of the samples are 0")
    assert "first in row 50" in words
    assert "leave these cells empty" in words


@pytest.mark.parametrize(
    ("unit", "period"), [("us", 2.0**32), ("ms", 2.0**16), ("us", 1e6), ("s", 86400.0)]
)
def test_a_clock_that_starts_again(unit: str, period: float) -> None:
    log = moving()
    right, _ = sampled(log)
    per_second = {"us": 1e6, "ms": 1e3, "s": 1.0}[unit]
    ticks = log["t"] * per_second
    configuration = in_memory(f'time.unit = "{unit}"\n' + configured())
    log["t"] = np.mod(ticks - min(3 * per_second, 0.3 * period), period)
    samples = sample(LogInMemory(Path("log"), log), configuration, 1e-3)
    (note,) = [each for each in samples.notes if isinstance(each, ClockStartedAgain)]
    assert note.period == period
    np.testing.assert_allclose(samples.values[:, 0], right["theta"], atol=1e-5)


def test_a_clock_that_is_set_back_once() -> None:
    """GIVEN a clock that steps back once, THEN the rows after the step follow after a gap."""
    log = moving()
    right, _ = sampled(log)
    log["t"][5000:] -= 0.4
    found, notes = sampled(log)
    (note,) = [each for each in notes if isinstance(each, ClockSetBack)]
    assert note.row == 5001
    assert note.step == pytest.approx(0.399)
    given = found["theta"][np.isfinite(found["theta"])]
    np.testing.assert_array_equal(given, right["theta"])
    assert len(found["theta"]) > ROWS + 900


def test_rows_in_a_wrong_order_are_refused() -> None:
    log = moving()
    log["t"][[3000, 3001]] = log["t"][[3001, 3000]]
    with pytest.raises(LogError, match="does not increase"):
        sampled(log)


def test_a_torque_that_is_0_throughout_tells_nothing(shell: Shell) -> None:
    Path("log.toml").write_text(configured("motor.gamma = 100", "prior.B = 1000.0"))
    write_log({**moving(), "tau": np.zeros(ROWS)}, Path("log.csv"))
    answer = shell.json("estimate log.csv")["answer"]
    assert answer.startswith("cannot tell: the torque is 0 throughout (tau)")


def merged() -> dict[str, Array]:
    """A log of 100 Hz in which each signal has rows of its own."""
    log = moving()
    rows = np.arange(0, ROWS, 10)
    t = np.ravel(np.column_stack([log["t"][rows] + late for late in (0.0, 1.2e-3, 2.4e-3)]))
    columns = {"t": t}
    for place, name in enumerate(("theta", "q", "tau")):
        columns[name] = np.full(len(t), np.nan)
        columns[name][place::3] = np.interp(t[place::3], log["t"], log[name])
    return columns


def test_the_period_is_that_of_the_samples_of_a_port() -> None:
    columns = read_columns(LogInMemory(Path("log"), merged()))
    (joint,) = guess(columns).values()
    assert joint.clock.interval == pytest.approx(0.01)
    assert joint.clock.longest_gap is None
    configuration = in_memory(configured("samplePeriod = 0.01"))
    samples = sample(LogInMemory(Path("log"), merged()), configuration, 0.01)
    assert np.isfinite(samples.values[1:-1]).all()
    assert not [note for note in samples.notes if isinstance(note, MissingSamples)]


def test_rows_of_a_second_publisher_do_not_change_the_period() -> None:
    log = moving()
    theta = np.insert(log["theta"][::10], np.arange(1, 800, 10), 0.0)
    q = np.insert(log["q"][::10], np.arange(1, 800, 10), 0.0)
    tau = np.insert(log["tau"][::10], np.arange(1, 800, 10), np.nan)
    t = np.insert(
        log["t"][::10], np.arange(1, 800, 10), log["t"][::10][np.arange(1, 800, 10)] - 4e-3
    )
    columns = {"t": t, "motor_position": theta, "link_position": q, "motor_torque": tau}
    (joint,) = guess(read_columns(LogInMemory(Path("log"), columns))).values()
    assert joint.clock.interval == pytest.approx(0.01)


def test_columns_of_different_rates_get_the_period_of_the_fastest() -> None:
    log = moving()
    columns = {"t": log["t"], "motor_position": log["theta"], "motor_torque": log["tau"]}
    columns["link_position"] = np.full(ROWS, np.nan)
    columns["link_position"][::5] = log["q"][::5]
    (joint,) = guess(read_columns(LogInMemory(Path("log"), columns))).values()
    assert joint.clock.interval == pytest.approx(1e-3)


def test_a_longest_gap_that_is_shorter_than_the_time_between_samples_is_refused() -> None:
    configuration = in_memory("time.longest_gap = 0.007\n" + configured())
    with pytest.raises(LogError, match=r"its samples are 0.01 s apart; remove longest_gap"):
        sample(LogInMemory(Path("log"), merged()), configuration, 1.2e-3)


def test_jitter_gives_no_odd_digits_to_the_period() -> None:
    t = 2e-3 * np.arange(5000) + np.random.default_rng(1).normal(0, 2e-5, 5000)
    assert interval(np.sort(t)) == 0.002
