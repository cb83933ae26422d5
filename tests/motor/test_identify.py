"""`sigmahat identify` finds the motor data of the AwAS from logs with encoders and noise."""

import math
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tomlkit

from checked_logs import RIGHT, knee_log, log_by_hand
from command_line import Shell
from recorded_logs import (
    CONFIGURATION,
    LEAD,
    TRUE,
    Columns,
    T,
    awas_log,
    configured,
    in_memory,
    recorded,
    write,
    write_log,
)
from regression_joint import Joint
from sigmahat.fmi.model import installed_model
from sigmahat.motor.coherence import coherent_range
from sigmahat.motor.equation import Form, equations, fit
from sigmahat.motor.identify import identify
from sigmahat.motor.noise import TorqueNoise
from sigmahat.motor.quantities import Identified, Quantity
from sigmahat.motor.signals import Signals
from sigmahat.recording.configuration import read_configuration
from sigmahat.recording.log import Array, LogInMemory
from sigmahat.recording.units import Conversion

Found = dict[float, Identified]
AMPLITUDES = {0.1: 0.3, 0.3: 0.3, 1.0: 0.3, 3.0: 0.3, 8.0: 0.5}  # frequency [Hz]: [N.m]


@pytest.fixture(scope="module")
def found() -> Found:
    """Results of `identify` by frequency, with start values that are wrong by 20 %."""
    return {f: identified(awas_log(f, A)) for f, A in AMPLITUDES.items()}


def identified(log: Mapping[str, Array], configuration: str = CONFIGURATION) -> Identified:
    return identify(LogInMemory(Path("log"), log), in_memory(configuration))


@pytest.fixture
def path(tmp_path: Path) -> Path:
    """Path of a file with a configuration."""
    path = tmp_path / "log.toml"
    path.write_text(CONFIGURATION)
    return path


@pytest.mark.slow("logs are simulated and identified")
def test_the_motor_and_the_noise_are_found(found: Found) -> None:
    for f in AMPLITUDES:
        for name, true in TRUE.items():
            quantity = found[f].quantities[name]
            is_shown = (name, f) != ("B", 0.1)  # at 0.1 Hz, B is not shown
            assert quantity.determined is is_shown or (name, f) == ("B", 0.3)  # within 10.6 %
            assert quantity.value == pytest.approx(true, rel=0.05) or not is_shown
    for f in (1.0, 3.0, 8.0):
        assert found[f].tau_variance == pytest.approx(1e-5, rel=0.1)
        assert found[f].theta_variance == pytest.approx((2 * np.pi / 40000) ** 2 / 12, rel=0.1)
        assert found[f].m == 3  # r^2, (28)
        V_a = found[f].V_a
        assert V_a is not None
        assert 1e8 <= V_a <= 1e13


@pytest.mark.slow("eight logs of 8 s, each simulated and identified")
def test_intervals_cover_the_truth() -> None:
    # If an interval covers the true value in 95 % of all cases, P(more than 3 of 24 miss it) = 3 %.
    misses = [
        (f, seed, name)
        for f in (0.3, 3.0)
        for seed in range(2, 6)
        for name, quantity in identified(awas_log(f, 0.3, 8.0, seed)).quantities.items()
        if abs(quantity.value - {**TRUE, "zero": 0.0}[name]) > quantity.half_width
    ]
    assert len(misses) <= 3


def test_the_old_name_of_determined(found: Found) -> None:
    quantity = found[0.1].quantities["B"]
    with pytest.warns(DeprecationWarning, match="determined"):
        assert quantity.told == quantity.determined


def test_a_joint_at_rest_determines_nothing() -> None:
    rng = np.random.default_rng(1)
    t = 1e-3 * np.arange(5000)
    rest = {"t": t, **{name: np.full(5000, 0.5) for name in ("theta", "q", "theta_c")}}
    quantities = identified({**rest, "tau": rng.normal(0, 3e-3, 5000)}).quantities
    assert not any(quantity.determined for quantity in quantities.values())


def test_command_writes_what_is_determined_and_keeps_the_comments(shell: Shell) -> None:
    write_log(awas_log(0.1, 0.3), Path("log.csv"), CONFIGURATION)
    result = shell.json("identify log.csv --dry-run")
    assert result["B"]["value"] is None and result["written"] == []
    assert Path("log.toml").read_text() == CONFIGURATION

    output = shell.run("identify log.csv")
    assert "cannot tell" in output and "N.m.s/rad" in output
    assert len(output.splitlines()) <= 24
    text = Path("log.toml").read_text()
    document = tomlkit.parse(text).unwrap()
    motor = document["parameters"]["motor"]
    assert motor["B"] == 1.84e-5  # an undetermined B is not written
    assert motor["D_theta"] == pytest.approx(1e-3, rel=0.05)
    assert document["identified"]["B"]["value"] == "cannot tell"
    assert document["parameters"]["prior"]["B"] == 1.0  # the default of 0 would mean an exact B
    for comment in ("# a comment of mine", "# on the axis of the motor", "# 20 % less than it is"):
        assert comment in text
    # THEN `estimate` can read the written configuration file.
    shell.run("estimate log.csv")


@pytest.mark.parametrize(
    "parameters",
    [
        "[parameters]\nmotor.B = 1.0 # mine",
        '[parameters]\n"motor.B" = 1.0 # mine',
        "[parameters]\nrls.n = 6\n[parameters.motor]\nB = 1.0 # mine",
        "[parameters]\nmotor = {B = 1.0} # mine",
    ],
)
def test_values_are_written_where_they_stand(parameters: str, found: Found, path: Path) -> None:
    path.write_text(f'[ports.q]\ncolumn = "q"\n{parameters}\n')
    written = write(found[1.0], path)
    read = read_configuration(path).parameters
    assert set(written) == {f"parameters.{name}" for name in read}
    installed_model("StiffnessEstimator").parameters(read)  # the FMU accepts all parameters
    for name, key in (("B", "motor.B"), ("D_theta", "motor.D_theta")):
        assert read[key] == pytest.approx(TRUE[name], rel=0.05)
    assert read["prior.tau_coulomb"] == pytest.approx(TRUE["tau_coulomb"], rel=0.05)
    assert read["noise.tau"] == pytest.approx(np.sqrt(1e-5), rel=0.05)
    assert "# mine" in path.read_text()


def cannot_tell(found: Identified) -> Identified:
    """Returns the result of `identify` with undetermined motor data. Only tau_coulomb has a finite
    interval. The user has not set B, so the default value of the FMU applies."""
    unknown = {name: replace(q, determined=False) for name, q in found.quantities.items()}
    unknown["B"] = replace(unknown["B"], value=math.nan, half_width=math.inf)
    unknown["tau_coulomb"] = Quantity(0.01, 0.05, "N.m", determined=False)
    return replace(found, quantities=unknown, B=2.3e-5)


@pytest.mark.parametrize(
    ("parameters", "kept"),
    [
        ("", {}),
        ("[parameters]\nprior.B = 0 # mine", {}),
        ("[parameters]\nprior = {B = 0} # mine", {}),
        ("[parameters]\nprior.B = 0.05 # mine", {"prior.B": 0.05}),
        ("[parameters]\nprior.D_theta = 0.3 # mine", {"prior.D_theta": 0.3}),
    ],
)
def test_what_is_not_determined_is_never_exact(
    parameters: str, kept: dict[str, float], found: Found, path: Path
) -> None:
    path.write_text(f'[ports.q]\ncolumn = "q"\n{parameters}\n')
    for _ in range(2):  # run 2 reads the file of run 1
        written = write(cannot_tell(found[1.0]), path)
        read = read_configuration(path).parameters
        wide = {"prior.B": 1000.0, "prior.D_theta": 1.0, "prior.tau_coulomb": 0.06, **kept}
        assert {name: read[name] for name in wide} == wide
        assert not any(f"parameters.{name}" in written for name in kept)
        # A comment marks the default values of B, without interval, and D_theta, with interval.
        friction = found[1.0].quantities["D_theta"]
        assert read["motor.B"] == pytest.approx(2.3e-5)
        assert read["motor.D_theta"] == pytest.approx(friction.value, rel=1e-5)
        assert {"parameters.motor.B", "parameters.motor.D_theta"} <= set(written)
        if "{" not in parameters:
            lines = [x for x in path.read_text().splitlines() if "# not known: " in x]
            assert len(lines) == 2
        assert ("# mine" in path.read_text()) == ("# mine" in parameters)
    # WHEN another log determines the motor data, THEN all marks of unknown values disappear.
    write(found[1.0], path)
    read = read_configuration(path).parameters
    inertia = found[1.0].quantities["B"]
    assert inertia.half_width / inertia.value < 0.15
    assert read["prior.B"] == 0.15  # the interval only covers random errors
    assert read["prior.tau_coulomb"] == pytest.approx(TRUE["tau_coulomb"], rel=0.05)
    if "{" not in parameters:  # an inline table cannot contain a comment
        assert read.get("prior.D_theta") == kept.get("prior.D_theta")
        assert "cannot tell" not in path.read_text()
        assert "not known" not in path.read_text()


def test_ranges_hold_what_the_log_shows(found: Found, path: Path) -> None:
    log = awas_log(1.0, 0.3)
    write(found[1.0], path)
    read = read_configuration(path).parameters
    lever = 100.0 - 1000 * LEAD * log["theta_c"]
    for name, largest in (
        ("range.phi", np.max(np.abs(log["q"] - log["theta"]))),
        ("range.setPoint", np.ptp(lever) / 2),
        ("prior.tau_e", 50 * np.max(np.abs(log["tau"]))),
    ):
        assert largest <= float(read[name]) <= 1.5 * largest
    assert read["range.setPoint_center"] == pytest.approx((lever.min() + lever.max()) / 2)


def test_a_log_at_one_set_point_keeps_the_order_that_others_need(found: Found, path: Path) -> None:
    at_one = replace(found[1.0], set_point_moves=False, m=1, set_point_center=0.0)
    given = {"rls.m": 3, "range.setPoint": 40.0, "range.setPoint_center": 70.0}
    lines = [f"{name} = {value}" for name, value in given.items()]
    path.write_text("\n".join([CONFIGURATION, *lines]))
    write(at_one, path)
    read = read_configuration(path).parameters
    assert {name: read[name] for name in given} == given
    # WHEN the user has not set the order rls.m, THEN `identify` writes 1.
    path.write_text(CONFIGURATION)
    write(at_one, path)
    assert read_configuration(path).parameters["rls.m"] == 1


def test_a_motor_that_is_off_shows_nothing_of_itself() -> None:
    """GIVEN a link moved by hand and a motor without torque, THEN no motor data are determined."""
    found, with_torque = (identified(log_by_hand(hold), RIGHT) for hold in (0.0, 0.05))
    assert not any(each.determined for each in found.quantities.values())
    assert "only noise" in found.notes[-1].in_words
    assert found.torque == 0
    assert with_torque.torque > 0 and len(with_torque.notes) == len(found.notes) - 1


def test_torque_constant(shell: Shell) -> None:
    # GIVEN a motor current, a torque constant that is wrong by 20 %, and a torque sensor
    log = awas_log(1.0, 0.3)
    write_log({**log, "tau": log["tau"] / 0.05}, Path("log.parquet"))
    text = f'ports.tau_e_sensor.column = "tau_e_sensor"\n{CONFIGURATION}'
    current = 'column = "tau"\nunit = "A"\ntorque_constant = 0.06'
    Path("log.toml").write_text(text.replace('column = "tau"', current))
    assert shell.run("identify log.parquet --torque-constant --quiet") == ""
    document = tomlkit.parse(Path("log.toml").read_text()).unwrap()
    assert document["ports"]["tau"]["torque_constant"] == pytest.approx(0.05, rel=0.05)
    assert document["parameters"]["motor"]["B"] == pytest.approx(TRUE["B"], rel=0.05)
    assert document["parameters"]["motor"]["D_theta"] == pytest.approx(TRUE["D_theta"], rel=0.05)


def test_a_value_instead_of_one_that_is_not_known_stays(found: Found, path: Path) -> None:
    # GIVEN a file in which `identify` has marked B as not known
    # WHEN a user changes B and prior.B but no comments, THEN `identify` keeps both values
    path.write_text('[ports.q]\ncolumn = "q"\n')
    write(cannot_tell(found[1.0]), path)
    text = path.read_text()
    assert "motor.B = 2.3e-05 #" in text and "prior.B = 1000.0 #" in text
    text = text.replace("motor.B = 2.3e-05", "motor.B = 1.2e-4")
    path.write_text(text.replace("prior.B = 1000.0", "prior.B = 0.1"))
    write(cannot_tell(found[1.0]), path)
    read = read_configuration(path).parameters
    assert (read["motor.B"], read["prior.B"]) == (1.2e-4, 0.1)


def test_a_torque_of_another_scale_does_not_replace_a_known_inertia() -> None:
    """GIVEN a torque that is 100 times too small, and a motor.B with a prior deviation of 10 %."""
    log = knee_log()
    wrong = RIGHT.replace("torque_constant", "gear_ratio = 100\ntorque_constant")
    found = identified(log, wrong)
    assert not found.quantities["B"].determined
    said = "".join(note.in_words for note in found.notes)
    assert "motor.B is 0.000105, known to 10 %: it is not written" in said
    # WHEN prior.B allows any value of B, or the torque is right, THEN B is determined.
    for text in (wrong.replace("prior.B = 0.1", "prior.B = 1000"), RIGHT):
        assert identified(log, text).quantities["B"].determined


def free_load(frequencies: Sequence[float]) -> Columns:
    """Simulates a free load of 0.6 kg.m2 on a spring of 7000 N.m/rad with a gear ratio of 50."""
    M, K, gear, B, D = 0.6, 7000.0, 50.0, 8e-5, 6e-4
    t = np.arange(0.0, 20.0, 0.002)
    theta, q, tau = np.zeros((3, len(t)))
    for f in frequencies:
        w = 2 * np.pi * f
        wave, velocity = 0.4 * np.sin(w * t), 0.4 * w * np.cos(w * t)
        link = 1 / (1 - M * w**2 / K)
        theta, q = theta + wave, q + link * wave
        tau += -B * gear * w**2 * wave + D * gear * velocity - K * (link - 1) * wave / gear
    theta, q = (
        2 * np.pi / n * np.round(x * n / 2 / np.pi) for x, n in ((theta, 2**14 * gear), (q, 2**15))
    )
    noise = 0.01 * np.random.default_rng(1).standard_normal(len(t))
    return {"t": t, "theta": theta, "q": q, "tau": tau + noise}


@pytest.mark.parametrize(("frequencies", "shown"), [((1.5,), False), ((1.5, 5.3, 11.0), True)])
def test_one_sine_of_a_free_load_does_not_tell_its_inertia_from_the_motors(
    frequencies: Sequence[float], shown: bool
) -> None:
    encoders = ["encoder.theta = 819200", "encoder.q = 32768", "samplePeriod = 0.002"]
    found = identified(free_load(frequencies), configured("motor.gamma = 50", *encoders))
    assert found.quantities["B"].determined is shown
    assert any("the inertia of the load" in note.in_words for note in found.notes) is not shown
    if shown:
        assert found.quantities["B"].value == pytest.approx(8e-5, rel=0.1)


@pytest.mark.parametrize("factor", [1.0, 2.0])
def test_a_stiffness_that_changes_in_the_log_does_not_look_like_inertia(factor: float) -> None:
    def stiffness(t: Array) -> Array:
        """Stiffness factor that compensates the moving lever arm, and that changes at t = 12 s."""
        steady: Array = (0.07 / (0.07 + 0.02 * np.sin(0.9 * t))) ** 2
        return steady * np.where(t < 12.0, 1.0, factor)

    joint = Joint(duration=24.0, stiffness=stiffness)
    found = identified(recorded(joint), configured("motor.gamma = 50"))
    assert found.quantities["B"].value == pytest.approx(TRUE["B"], rel=0.03)
    said = "".join(note.in_words for note in found.notes)
    times = re.findall(r"the stiffness changes after (\S+) s", said)
    assert [float(t) for t in times] == ([] if factor == 1 else [pytest.approx(12.0, abs=0.3)])


def test_the_zero_is_where_the_spring_has_no_torque(path: Path) -> None:
    log = awas_log(1.0, 0.3, 8.0)
    true, offset = log["q"], 15e-3
    log = {**log, "q": 0.5 - 2.0 * np.degrees(true + offset)}
    column = '"q"\nunit = "deg"\nsign = -1\nzero = 0.5\ngear_ratio = 2.0'
    path.write_text(CONFIGURATION.replace('"q"', column))
    found = identified(log, path.read_text())
    zero = found.quantities["zero"]
    assert zero.determined
    assert abs(zero.value - offset) <= zero.half_width < 5e-3
    assert found.phi == pytest.approx(np.max(np.abs(true - log["theta"])), abs=zero.half_width)
    assert "ports.q.zero" in write(found, path)
    q = Conversion.of("q", read_configuration(path).ports["q"]).apply(log["q"])
    assert np.max(np.abs(q - true)) <= zero.half_width
    # THEN a second run of `identify` does not change the zero of the encoder.
    again = identified(log, path.read_text())
    assert again.zero == 0 and "ports.q.zero" not in write(again, path)


def motor(noise_of_phi: float, noise: float = 3e-3) -> Signals:
    """Simulates a motor with a spring of 300 N.m/rad, a torque with noise, and a noisy phi."""
    rng = np.random.default_rng(1)
    t = T * np.arange(20000)
    theta = np.sin(2 * np.pi * 0.7 * t)
    velocity = 2 * np.pi * 0.7 * np.cos(2 * np.pi * 0.7 * t)
    phi = 0.01 * np.sin(3.0 * t) + 0.01 * np.sin(2 * np.pi * 1.5 * t)
    acceleration = -((2 * np.pi * 0.7) ** 2) * theta
    tau = 2e-5 * 50 * acceleration + 1e-3 * 50 * velocity - 300 * phi / 50
    tau = tau + rng.normal(0, noise, len(t))
    return Signals(theta, phi + rng.normal(0, noise_of_phi, len(t)), np.ones_like(t), tau, None)


def test_without_noise_and_rounding_the_equations_hold() -> None:
    exact = motor(0.0, noise=0.0)
    piece = replace(exact, tau=exact.tau + 0.03)
    result = fit(equations([piece], T, 50.0, Form(40.0, 100.0)))
    assert result.value["B"] == pytest.approx(2e-5, rel=1e-3)
    assert result.value["D_theta"] == pytest.approx(1e-3, rel=1e-4)
    assert abs(result.value["tau_coulomb"]) < 1e-5
    assert result.value["constant"] == pytest.approx(0.03, rel=1e-3)
    k = -50 * result.value["eta[0,0]"] / np.max(np.abs(piece.phi))
    assert k == pytest.approx(300.0, rel=1e-3)


def log_of(joint: Signals) -> Columns:
    t: Array = np.arange(len(joint.theta)) * np.float64(T)
    q = joint.theta + joint.phi
    return {"t": t, "theta": joint.theta, "q": q, "theta_c": 0 * t, "tau": joint.tau}


def test_with_a_wrong_sign_the_zero_stays(path: Path) -> None:
    log = awas_log(1.0, 0.3, 8.0)
    log = {**log, "q": 2 * log["theta"] - log["q"] + 15e-3}  # phi with the wrong sign
    found = identified(log)
    assert not found.quantities["zero"].determined
    assert "ports.q.zero" not in write(found, path)


def test_the_prior_holds_what_encoders_read_at_different_times_show(path: Path) -> None:
    # GIVEN a link encoder with a delay of 20 ms, which causes an error that resembles friction
    late, log = 20, log_of(motor(0.0))
    q = log["q"]
    found = identified({**log, "q": np.concatenate([q[:late], q[:-late]])})
    D_theta = found.quantities["D_theta"]
    assert not D_theta.determined
    assert D_theta.value == pytest.approx(1e-3 - 300 * late * T / 50**2, rel=0.05)
    write(found, path)
    prior = float(read_configuration(path).parameters["prior.D_theta"])
    assert prior > 1
    for end in D_theta.fitted:
        assert abs(end - 1.2e-3) <= prior * 1.2e-3 * (1 + 1e-5)


@pytest.mark.parametrize("name", ["B", "D_theta"])
def test_the_estimator_accepts_whatever_identify_holds_possible(
    name: str, found: Found, path: Path
) -> None:
    # GIVEN a value whose printed interval reaches far beyond that of the fits
    value, half_width = 1.2e-4, 1.18e-4
    unclear = Quantity(value, half_width, "", determined=False)
    result = replace(found[1.0], quantities={**found[1.0].quantities, name: unclear})
    path.write_text('[ports.q]\ncolumn = "q"\n')
    write(result, path)
    read = read_configuration(path).parameters
    middle, prior = float(read[f"motor.{name}"]), float(read[f"prior.{name}"])
    assert middle == pytest.approx(value, rel=1e-3)
    assert unclear.interval[1] > 5 * middle
    # THEN the value is at most three standard deviations of the prior away (SH_OUTSIDE_PRIOR)
    assert middle * (1 + 3 * prior) >= unclear.interval[1] * (1 - 1e-5)


@pytest.mark.parametrize(("noise_of_phi", "is_noise"), [(1e-7, False), (2e-3, True)])
def test_a_noisy_deformation_limits_the_bandwidth(noise_of_phi: float, is_noise: bool) -> None:
    equal_at_40_Hz = 9e-6 / (1e-3 * (2 * np.pi * 40) ** 2) ** 2
    noise = TorqueNoise(torque=9e-6, position=equal_at_40_Hz, inertia=1e-3, T=T)
    assert noise.bandwidth == pytest.approx(40.0)
    limit = coherent_range(motor(noise_of_phi), 50.0, noise)
    assert (limit < 6.0) if is_noise else limit == math.inf


def test_a_torque_that_is_late_does_not_look_like_friction() -> None:
    # GIVEN a torque that acts 2 ms after its sample, so that the spring resembles friction
    late, log = 2, log_of(motor(1e-7))
    found = identified({**log, "tau": np.roll(log["tau"], -late)})
    for name, true in (("B", 2e-5), ("D_theta", 1e-3)):
        quantity = found.quantities[name]
        assert abs(quantity.value - true) <= quantity.half_width < 0.05 * true
