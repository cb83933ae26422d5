"""`sigmahat validate` tests whether a second log of a joint confirms the estimated stiffness."""

import re
import shutil
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from command_line import Shell
from recorded_logs import CONFIGURATION, REGRESSION, Array, awas_log, estimated, write_log
from sigmahat.result.validate import agreement

KNEE = REGRESSION + "prior.B = 0.2\n"
DURATION = 10.0
SOFT = {"spring.k_s": 0.8 * 14220.0}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the results of a first log, and with three other logs."""
    folder, log = tmp_path_factory.mktemp("validate"), awas_log(1.0, 0.3, DURATION)
    write_log(awas_log(1.3, 0.3, DURATION, seed=2), folder / "same.parquet")
    write_log(awas_log(1.3, 0.3, DURATION, seed=2, plant=SOFT), folder / "softer.parquet")
    still = {name: np.full_like(values, values[0]) for name, values in log.items()}
    write_log({**still, "t": log["t"]}, folder / "still.parquet")
    return estimated(folder, log, KNEE)


@pytest.fixture
def knee(folder: Path, shell: Shell) -> Shell:
    """A shell in a copy of the folder with logs."""
    shutil.copytree(folder, Path(), dirs_exist_ok=True)
    return shell


WITH = "--with knee.toml"


def keys(values: object) -> Iterator[str]:
    """All keys in a JSON document, at any depth."""
    if isinstance(values, dict):
        yield from values
    if isinstance(values, (dict, list)):
        for value in values.values() if isinstance(values, dict) else values:
            yield from keys(value)


@pytest.mark.parametrize(
    ("command", "status"),
    [("estimate", 0), ("check", 0), ("identify --dry-run", 0), (f"validate {WITH}", 1)],
)
def test_keys_of_json_are_identifiers_and_units_stand_beside_them(
    knee: Shell, command: str, status: int
) -> None:
    name, *options = command.split()
    values = knee.json(" ".join([name, "knee.parquet", *options]), status)
    assert not [key for key in keys(values) if re.search(r"[\s\[]", key)]
    assert values["units"].keys() & {*keys({**values, "units": {}})}
    assert all(note["kind"].isidentifier() for note in values.get("notes", []))


def test_another_log_of_the_same_joint_agrees_and_a_softer_spring_does_not(knee: Shell) -> None:
    same = knee.json(f"validate same.parquet {WITH}")
    assert knee.err == ""
    assert same["agree"] is True and not same["repeated"]
    assert same["z"] < 1.96
    assert same["learned_from"] == ["knee.parquet"]
    assert same["start_from"] == "sigmahat-results/knee/state.json"
    assert same["this_log_within_learned"] > 0.9 and same["learned_within_this_log"] > 0.9
    assert same["overlap"] > 0.99
    # THEN the model predicts the torque, and even better below 2 Hz, where noise is smaller.
    assert same["torque"]["relative"] < 0.05
    assert same["torque_below_2_Hz"]["relative"] < 0.02
    assert 0.9 < same["torque"]["share"] <= 1.0
    # THEN the stiffness equals the median of the true stiffness over the log.
    true = np.median(awas_log(1.3, 0.3, DURATION, seed=2)["true"])
    learned, alone = "stiffness_learned", "stiffness_of_this_log"
    for name in (learned, alone):
        value, half = same[name]
        assert abs(value - true) < half + 0.02 * true
    # WHEN the spring is 20 % softer
    softer = knee.json(f"validate softer.parquet {WITH}", 1)
    assert softer["agree"] is False
    assert softer["z"] > 3
    assert softer["this_log_within_learned"] < 0.1 and softer["learned_within_this_log"] < 0.1
    # THEN the model of the first log leaves 10 to 25 % of the torque unexplained.
    for name in ("torque", "torque_below_2_Hz"):
        assert 0.1 < softer[name]["relative"] < 0.25
        assert softer[name]["relative"] > 5 * same[name]["relative"]
    assert softer[alone][0] / softer[learned][0] == pytest.approx(0.8, abs=0.08)


def test_a_log_without_motion_cannot_tell_and_nothing_is_written(knee: Shell) -> None:
    before = {path: path.stat().st_mtime_ns for path in Path().rglob("*")}
    result = knee.json(f"validate still.parquet {WITH}", 1)
    assert result["agree"] is None
    assert result["torque"] is None and result["torque_below_2_Hz"] is None
    start = "--start-from sigmahat-results/knee/state.json"
    text = knee.run(f"validate still.parquet {WITH} {start}", 1)
    assert "cannot tell: too few samples in motion" in text
    assert text.rstrip().endswith("cannot tell: an interval is wider than the stiffness itself")
    assert {path: path.stat().st_mtime_ns for path in Path().rglob("*")} == before


def test_a_log_that_was_learned_from_confirms_nothing(knee: Shell) -> None:
    result = knee.json(f"validate knee.parquet {WITH}", 1)
    assert result["repeated"] is True and result["agree"] is None
    # THEN both stiffnesses are exactly equal, as both come from the same state of the estimator.
    assert result["z"] == 0.0
    assert result["stiffness_learned"] == result["stiffness_of_this_log"]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("nothere.csv --with knee.toml", "nothere.csv: No such file"),
        ("same.parquet --with nothere.toml", "nothere.toml: No such file"),
        ("same.parquet --with other.toml", "sigmahat-results/other: "),
        ("same.parquet --with other.toml", "name the folder or the state.json"),
        ("same.parquet --with knee.toml --start-from knee.toml", "got no JSON"),
        ("same.parquet --with b.toml --start-from sigmahat-results/knee", "motor.B = 2e-05, but"),
        ("same.parquet --with paper.toml --start-from sigmahat-results/knee", "gives no interval"),
    ],
)
def test_wrong_arguments(arguments: str, words: str, knee: Shell) -> None:
    Path("other.toml").write_text(KNEE)
    Path("b.toml").write_text(KNEE.replace("1.84e-5", "2e-5"))
    Path("paper.toml").write_text(CONFIGURATION)
    assert words in knee.refused(f"validate {arguments}")


# ---- functions of the validation ----------------------------------------------------------------


def estimates(sigma: float, std: float, per_gain: float = 1.0) -> dict[str, Array]:
    values = {"sigma": sigma, "sigma_std": std, "sigma_per_gain": per_gain}
    return {name: np.full(4, value) for name, value in values.items()}


def test_agreement_in_figures() -> None:
    # GIVEN 100 +- 2 and 105 +- 3, THEN the normalised difference is 5 / sqrt(4 + 9).
    found = agreement(estimates(100.0, 2.0), estimates(105.0, 3.0), 0.0)
    assert found.z == pytest.approx(5 / np.sqrt(13))
    assert found.before == pytest.approx((100.0, 3.92)) and found.alone == (105.0, 3 * 1.96)
    assert (found.alone_in_before, found.before_in_alone, found.overlap) == (0.0, 1.0, 1.0)
    assert found.agree is True
    far = agreement(estimates(100.0, 2.0), estimates(120.0, 3.0), 0.0)
    assert far.agree is False and far.overlap == 0.0


def test_the_gain_of_the_torque_is_one_error_of_both() -> None:
    """A torque gain widens both intervals, but hardly explains a difference between two logs."""
    # GIVEN a standard deviation of 10 % from the gain, and an independent part of 0.5
    before, alone = (estimates(x, float(np.hypot(0.5, 0.1 * x))) for x in (100.0, 105.0))
    found = agreement(before, alone, 0.1)
    assert found.alone_in_before == 1.0
    assert found.z == pytest.approx(5 / np.sqrt(2 * 0.5**2 + 0.5**2), rel=1e-6)
    assert found.agree is False
