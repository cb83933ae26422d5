"""Tests of `sigmahat check` with good logs, and with wrong configurations of a good log."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
import pytest

from checked_logs import (
    GEAR,
    KNEE,
    RIGHT,
    SINES,
    WRONG,
    Array,
    as_recorded,
    joint_log,
    knee_log,
    log_by_hand,
    log_of_a_hardening_spring,
    log_under_gravity,
)
from command_line import Shell
from recorded_logs import CONFIGURATION, awas_log, configured, in_memory, write_log
from sigmahat.checks.check import check
from sigmahat.checks.contradictions import of_sizes
from sigmahat.checks.findings import Checked, Finding, Kind, Severity
from sigmahat.checks.text import sentence
from sigmahat.motor.hypotheses.positions import compare_positions
from sigmahat.motor.log_view import liveliest_part
from sigmahat.recording.log import LogInMemory
from sigmahat.result.curve import stiffness_in_the_middle
from sigmahat.result.estimate import estimate

ANY_MOTOR = (f"motor.gamma = {GEAR}", "samplePeriod = 0.001")
"""Parameters of a joint whose motor is not known."""


def checked(columns: Mapping[str, Array], text: str) -> Checked:
    return check(LogInMemory(Path("log"), columns), in_memory(text))


def wrong(columns: Mapping[str, Array], text: str) -> list[Finding]:
    return [*checked(columns, text).of(Severity.WRONG)]


PROPOSED = {
    "torque sign": 1.0,
    "link sign": 1.0,
    "link offset 1 degree": pytest.approx(0.0, abs=0.01),
    "degrees as rad": "deg",
    "counts per turn x 4": 4096.0,
    "theta without its gear": 100.0,
    "gamma 80": 100.0,
    "torque 10 ms late": pytest.approx(0.010, abs=0.0005),
    "torque geared twice": 1.0,
}
"""The right values of all keys whose right value a log can show."""


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_key_is_named_first_with_the_right_value(name: str) -> None:
    old, new, keys = WRONG[name]
    assert old in RIGHT
    found = checked(knee_log(), RIGHT.replace(old, new))
    if name == "torque constant + 10 %":  # no log shows this error
        assert not found.is_wrong
        assert keys[0] in [each.key for each in found.of(Severity.RESTS_ON)]
    else:
        first = found.of(Severity.WRONG)[0]
        assert len(found.of(Severity.WRONG)) == 1
        assert first.key in keys
        assert first.key in sentence(first)
        assert name not in PROPOSED or first.proposed == PROPOSED[name]


EVEN_POWERS = RIGHT.replace("rls.n = 1", "rls.symmetric = false\nrls.n = 6")
"""A configuration as `identify` writes it for most joints: the polynomial has even powers, too."""


@pytest.mark.parametrize(
    ("gear", "gamma", "right"),
    [
        *((10.0, True, RIGHT), (1000.0, False, RIGHT), (0.01, True, RIGHT)),
        *((-100.0, False, RIGHT), (101.0, True, RIGHT), (101.0, False, RIGHT)),
        *((gear, False, EVEN_POWERS) for gear in (10.0, 0.01, 101.0)),
    ],
)
def test_a_wrong_gear_ratio_is_named(gear: float, gamma: bool, right: str) -> None:
    """GIVEN a wrong gear ratio of the encoder, and a motor.gamma that is right or equally wrong."""
    text = right.replace("gear_ratio = 100", f"gear_ratio = {gear}")
    if gamma:
        text = text.replace("gamma = 100", f"gamma = {abs(gear)}")
    first = wrong(knee_log(), text)[0]
    assert (first.key, first.proposed) == ("ports.theta.gear_ratio", 100.0)


@pytest.mark.parametrize("hold", [0.0, 0.05])
@pytest.mark.parametrize("gear", [10.0, 1000.0, 0.01, -100.0])
def test_a_wrong_gear_ratio_is_named_if_a_hand_moves_the_link(gear: float, hold: float) -> None:
    """GIVEN a motor torque that is zero, or the torque of a controller that acts like a spring."""
    right = EVEN_POWERS.replace("range.phi = 0.03", "range.phi = 0.05")
    log = log_by_hand(hold)
    assert wrong(log, right) == []
    first = wrong(log, right.replace("gear_ratio = 100", f"gear_ratio = {gear}"))[0]
    assert (first.key, first.proposed) == ("ports.theta.gear_ratio", 100.0)


def test_counts_and_a_gear_ratio_that_explain_the_same_are_both_named() -> None:
    half = RIGHT.replace("gear_ratio = 100", "gear_ratio = 50").replace("gamma = 100", "gamma = 50")
    first = wrong(knee_log(), half)[0]
    assert (first.key, first.proposed) == ("ports.theta.counts_per_turn", 8192.0)
    assert dict(first.others)["ports.theta.gear_ratio"] == 100.0


@pytest.mark.parametrize("right", [RIGHT, EVEN_POWERS])
@pytest.mark.parametrize("change", [0.0, 1.0])
def test_a_stiffness_that_doubles_is_no_gear_ratio(change: float, right: str) -> None:
    assert wrong(log_under_gravity(change), right) == []


def test_a_gear_ratio_upside_down_is_no_swap_of_columns_in_one_unit() -> None:
    """GIVEN motor and link in rad, an inverted gear ratio could be mistaken for swapped columns."""
    log = joint_log(KNEE, 1e-3)
    columns = {**knee_log(), "motor_rad": GEAR * log["theta"], "link_rad": log["q"]}
    text = RIGHT.replace('"motor_counts"\nunit = "counts"\ncounts_per_turn = 4096', '"motor_rad"')
    text = text.replace("gear_ratio = 100\nzero = 1500", "gear_ratio = 0.01")
    text = text.replace('"link_deg"\nunit = "deg"', '"link_rad"')
    first = wrong(columns, text)[0]
    assert (first.key, first.proposed) == ("ports.theta.gear_ratio", 100.0)


def test_columns_that_are_swapped_are_said_as_that() -> None:
    text = RIGHT.replace("motor_counts", "X").replace("link_deg", "motor_counts")
    (found,) = wrong(knee_log(), text.replace("X", "link_deg"))
    assert (found.key, found.proposed) == ("ports.theta.column", "motor_counts")
    assert "swapped" in sentence(found)


def test_what_identify_will_set_is_no_finding_before_it() -> None:
    text = RIGHT.replace("range.phi = 0.03\n", "").replace("prior.tau_e = 20\n", "")
    text = text.replace("B = 1.05e-4", "B = 2.3e-5").replace("prior.B = 0.1", "prior.B = 1000")
    strong = {**KNEE, "spring.k_1": 2e4, "motor.gamma": GEAR, "motor.B": 2e-3}
    for plant in (KNEE, strong):
        columns = as_recorded(joint_log(plant, 1e-3, 400.0))
        found = checked(columns, text)
        assert [*found.of(Severity.WRONG)] == []
        # Without ranges and noise, the estimator sees changes and misfits that are none.
        assert [sentence(each) for each in found.of(Severity.NOTE)] == []


@pytest.mark.parametrize(
    ("still", "words"),
    [
        (["motor_counts", "link_deg"], "the joint is at rest"),
        (["link_deg"], "the link does not move while the motor does"),
        (["motor_counts"], "the motor does not move while the link does"),
    ],
)
def test_positions_that_do_not_change(still: list[str], words: str) -> None:
    log = {name: np.full_like(c, c[0]) if name in still else c for name, c in knee_log().items()}
    (found,) = wrong(log, RIGHT)
    assert words in sentence(found)


def test_a_link_that_is_locked_on_purpose_needs_no_column() -> None:
    plant = {**KNEE, "contact.k": 1e7, "contact.d": 1e3}
    log = {name: x for name, x in joint_log(plant, 1e-3).items() if name != "q"}
    text = parameters(KNEE, 1e-3).replace('ports.q.column = "q"', "ports.q.value = 0")
    assert wrong(log, text) == []
    branch = estimate(LogInMemory(Path("log"), log), in_memory(text)).curve.branches[0]
    _, _, interval = stiffness_in_the_middle(branch)
    assert interval is not None
    low, high = interval
    assert low < KNEE["spring.k_1"] < high < 1.2 * low


def parameters(plant: Mapping[str, float], T: float) -> str:
    """A configuration with motor data that are wrong by some per cent, in rad and N.m."""
    return configured(
        f"samplePeriod = {T}",
        f"motor.B = {1.05 * plant['motor.B']}",
        f"motor.D_theta = {0.9 * plant['motor.D_theta']}",
        "prior.B = 0.1",
        "rls.m = 1",
        *(f"{n} = {plant[n]}" for n in ("motor.gamma", "encoder.theta", "encoder.q")),
    )


GOOD = {
    "stiff at 4 ms": ({"spring.k_1": 3000.0, "motor.gamma": 160.0}, 4e-3, 0.0),
    "hardening with gravity": (
        {"spring.k_1": 100.0, "spring.k_3": 2e4, "link.mgl": 3.0, "motor.gamma": 50.0},
        2e-3,
        0.0,
    ),
    "soft under a load": ({"spring.k_1": 80.0, "link.mgl": 5.0, "motor.gamma": 30.0}, 2e-3, -3.0),
    "coarse encoders": ({"encoder.theta": 51200.0, "encoder.q": 8192.0}, 1e-3, 0.0),
    "friction of other forms": (
        {"motor.load_friction": 0.1, "motor.stribeck": 0.3, "motor.uneven": 0.1}
        | {"spring.damping": 1e-3, "spring.dahl": 0.2},
        1e-3,
        0.0,
    ),
}


@pytest.mark.parametrize("name", GOOD)
def test_no_false_alarm(name: str) -> None:
    changed, T, load = GOOD[name]
    plant = {**KNEE, **changed}
    assert wrong(joint_log(plant, T, load), parameters(plant, T)) == []


def test_no_false_alarm_with_a_set_point() -> None:
    text = CONFIGURATION + 'method = "FilteredRegression"\n'
    assert wrong(awas_log(1.0, 0.3), text) == []


def test_a_value_that_does_not_help_is_not_proposed() -> None:
    # GIVEN a zero that is wrong, of a spring so curved that the tangent shows half of it
    (found,) = wrong(log_of_a_hardening_spring(0.02), RIGHT)
    assert found.kind is Kind.ZERO and 0 < float(str(found.measured)) < 0.015
    # THEN both keys are named, but none with a value, because neither removes the finding
    assert found.keys == ("ports.q.zero", "ports.theta.zero")
    assert found.proposed is None and [value for _, value in found.others] == [None]


def test_a_wrong_sign_of_theta_and_torque_is_that_of_the_link() -> None:
    text = parameters(KNEE, 1e-3)
    for name in ("theta", "tau"):
        text = f"ports.{name}.sign = -1\n{text}"
    (found,) = wrong(joint_log(KNEE, 1e-3), text)
    assert (found.key, found.proposed) == ("ports.q.sign", -1.0)


def test_a_counter_that_wraps_is_named_with_its_period() -> None:
    wrapped = {**knee_log(), "motor_counts": np.mod(knee_log()["motor_counts"], 4096)}
    (found,) = wrong(wrapped, RIGHT)
    assert (found.kind, found.key) == (Kind.JUMP, "ports.theta.wrap")
    assert found.proposed == 4096


def test_single_samples_that_were_lost_are_counted() -> None:
    link = np.array(knee_log()["link_deg"])
    link[1000:12_000:1000] += 90.0
    (found,) = wrong({**knee_log(), "link_deg": link}, RIGHT)
    assert (found.kind, found.key, found.expected) == (Kind.SPIKE, "ports.q.column", 11)
    assert found.measured == pytest.approx(90.0, abs=1.0)


@pytest.mark.parametrize(("sample", "are_lost"), [(0, True), (40_000, True), (65_535, False)])
def test_a_lost_sample_of_a_counter_differs_from_one_that_wraps(
    sample: int, are_lost: bool
) -> None:
    """GIVEN a 16-bit counter in which a wrong value replaces the largest value `sample`, THEN the
    sample counts as lost. A value that is one count more because of the wrap is not lost."""
    counts = knee_log()["motor_counts"]
    largest = int(np.argmax(counts))
    wrapped = np.mod(counts - counts[largest] + sample, 65_536)
    zero = 1500 + wrapped[0] - counts[0]
    wrapped[largest] = 20_000 if sample == 0 else 0
    text = RIGHT.replace("zero = 1500", f"zero = {zero}\nwrap = 65536")
    found = wrong({**knee_log(), "motor_counts": wrapped}, text)
    assert [each.kind for each in found] == [Kind.SPIKE] * are_lost


def test_the_unit_of_both_positions_shows_in_the_steps_of_the_encoders() -> None:
    text = parameters(KNEE, 1e-3)
    for name in ("theta", "q"):
        text = f'ports.{name}.unit = "deg"\n{text}'
    found = checked(joint_log(KNEE, 1e-3), text).findings
    keys = {each.key: each.proposed for each in found if each.kind is Kind.STEP}
    assert keys == {"ports.theta.unit": "rad", "ports.q.unit": "rad"}


def test_a_torque_behind_the_gear_shows_in_the_inertia() -> None:
    log = joint_log(KNEE, 1e-3)
    (found,) = wrong({**log, "tau": GEAR * log["tau"]}, parameters(KNEE, 1e-3))
    assert (found.key, found.proposed) == ("ports.tau.gear_ratio", GEAR)


def test_what_no_log_shows_is_listed() -> None:
    text = RIGHT.replace("motor.B = 1.05e-4\n", "")
    found = [sentence(each) for each in checked(knee_log(), text).of(Severity.RESTS_ON)]
    assert "motor.B: 2.3e-05 is the start value, of another robot" in found
    theta = "ports.theta.unit: theta is the position of the motor's shaft, before a gear of 100"
    assert f"{theta}, in counts" in found
    assert "ports.q.unit: q is the position of the link, in deg" in found
    current = "ports.tau.gear_ratio: 1 A is 0.05 N.m, the torque of the motor, before the gear"
    assert current in found


def test_the_effect_of_the_gain_does_not_depend_on_the_last_sample() -> None:
    # GIVEN a dead zone for which there is no column, so that the stiffness is small in the middle
    log = as_recorded(joint_log({**KNEE, "spring.gap": 4e-3}, 1e-3))
    text = RIGHT.replace("rls.n = 1", "rls.n = 4\nprior.gap = 0")
    effects = []
    for end in (15000, 19500, 19782):
        found = checked({name: column[:end] for name, column in log.items()}, text)
        effects += [each.measured for each in found.findings if each.kind is Kind.TORQUE_GAIN]
    assert len(effects) == 3 and np.ptp(effects) < 0.03


def test_a_torque_that_saturates_is_noted() -> None:
    log = joint_log(KNEE, 1e-3)
    limit = 0.8 * sum(A for A, *_ in SINES)
    flat = {**log, "tau": np.clip(log["tau"], -limit, limit)}
    found = checked(flat, parameters(KNEE, 1e-3))
    assert Kind.SATURATION in [each.kind for each in found.findings]


def test_a_torque_that_is_only_noise_is_noted() -> None:
    for hold, noted in ((0.0, True), (0.05, False)):
        found = checked(log_by_hand(hold), RIGHT)
        assert (Kind.NO_TORQUE in [each.kind for each in found.findings]) is noted
    # WHEN B is not known either, `check` does not report a negative stiffness as a wrong sign.
    text = RIGHT.replace("motor.B = 1.05e-4\n", "").replace("prior.B = 0.1", "prior.B = 1000")
    found = checked(log_by_hand(0.0), text)
    assert not any(each.about == "NegativeStiffness" for each in found.findings)


def test_the_command(shell: Shell) -> None:
    write_log({name: column[:8000] for name, column in knee_log().items()}, Path("knee.csv"), RIGHT)
    assert "nothing" in shell.run("check knee.csv")
    Path("wrong.toml").write_text(RIGHT.replace("= 4096", "= 16384"))
    result = shell.json("check knee.csv --config wrong.toml", 1)
    (found,) = [each for each in result["findings"] if each["severity"] == "wrong"]
    assert (found["key"], found["proposed"]) == ("ports.theta.counts_per_turn", 4096)
    said = shell.refused("check knee.csv --config none.toml")
    assert said.startswith("sigmahat: error: none.toml: No such file")
    # THEN `identify` and `estimate` report the same findings as `check`.
    said = shell.run("identify knee.csv --config wrong.toml --dry-run")
    assert "ports.theta.counts_per_turn" in said
    assert shell.json("estimate knee.csv")["checks"]["wrong"] is False


@pytest.mark.parametrize(
    ("port", "factor", "size", "severity"),
    [
        ("tau", 200.0, "torque after the gear", Severity.NOTE),
        ("tau", 5e4, "torque after the gear", Severity.WRONG),
        ("q", 1.0, "deformation", Severity.NOTE),
    ],
)
def test_a_size_of_no_usual_joint_is_said(
    port: str, factor: float, size: str, severity: Severity
) -> None:
    log = joint_log(KNEE, 1e-3)
    wrong = {**log, port: factor * log[port] + (2.0 if port == "q" else 0.0)}
    view = liveliest_part(LogInMemory(Path("log"), wrong), in_memory(configured(*ANY_MOTOR)))
    found = [each for each in of_sizes(compare_positions(view)) if each.about == size]
    assert [each.severity for each in found] == [severity]


def test_motor_and_link_that_are_swapped_after_the_gear_are_named() -> None:
    """GIVEN both in rad after the gear, so that their motions do not show which is which."""
    log = joint_log({**KNEE, "spring.k_1": 300.0}, 1e-3)
    right = configured(*ANY_MOTOR)
    assert "swap" not in [each.about for each in wrong(log, right)]
    found = wrong({**log, "theta": log["q"], "q": log["theta"]}, right)
    (swap,) = [each for each in found if each.about == "swap"]
    assert (swap.key, swap.proposed) == ("ports.theta.column", "q")
    assert swap.others == [("ports.q.column", "theta")]
    assert "are swapped" in sentence(swap)
    assert sentence(swap).endswith('try "q" and ports.q.column = "theta"')


def test_degrees_that_count_as_rad_are_a_deformation_of_no_spring() -> None:
    """GIVEN both positions in degrees, of a soft joint, THEN no zero explains the deformation."""
    log = joint_log({**KNEE, "spring.k_1": 100.0}, 1e-3)
    wrong = {**log, **{name: np.degrees(log[name]) for name in ("theta", "q")}}
    view = liveliest_part(LogInMemory(Path("log"), wrong), in_memory(configured(*ANY_MOTOR)))
    (found,) = [each for each in of_sizes(compare_positions(view)) if each.about == "deformation"]
    assert found.severity is Severity.WRONG
    assert found.keys == ("ports.q.unit", "ports.theta.unit")


def test_the_inertia_at_the_link_is_a_size() -> None:
    """GIVEN a torque 80 times too large, THEN it is below that of a large robot, and the inertia of
    the motor is not."""
    log = joint_log(KNEE, 1e-3)
    view = liveliest_part(
        LogInMemory(Path("log"), {**log, "tau": 80 * log["tau"]}), in_memory(configured(*ANY_MOTOR))
    )
    (found,) = of_sizes(compare_positions(view))
    assert found.about == "inertia of the motor at the link"
    assert found.measured == pytest.approx(80 * KNEE["motor.B"] * GEAR**2, rel=0.05)


def test_the_largest_torque_is_said_for_comparison() -> None:
    log = joint_log(KNEE, 1e-3)
    found = checked(log, configured(*ANY_MOTOR)).of(Severity.RESTS_ON)
    (largest,) = (each for each in found if each.kind is Kind.LARGEST_TORQUE)
    assert largest.measured == pytest.approx(GEAR * np.max(np.abs(log["tau"])))
    assert "compare with the data sheet of the joint" in sentence(largest)
