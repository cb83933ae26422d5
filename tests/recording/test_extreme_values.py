"""Values of a configuration at the limits of their types are read, or refused in one line."""

from pathlib import Path

import pytest

from recorded_logs import CONFIGURATION
from sigmahat.recording.configuration import read_configuration
from sigmahat.recording.estimator_parameters import all_parameters
from sigmahat.recording.log import LogError
from sigmahat.recording.readers.formats import open_log


@pytest.mark.parametrize(
    ("line", "words"),
    [
        ("method = 3", "method: expected one of Paper2011, FilteredRegression, got 3"),
        ("method = -1", "method: expected one of"),
        ("method = 9e99", "method: expected one of"),
        ("modality = 7", "modality: expected one of"),
        (f'modality = "{"x" * 5000}"', "unknown value of"),
        (f"rls.n = {'9' * 4000}", "rls.n: expected Integer of 32 bits"),
    ],
)
def test_parameters(line: str, words: str, tmp_path: Path) -> None:
    path = tmp_path / "log.toml"
    path.write_text(CONFIGURATION.replace("motor.B", f"{line}\nmotor.B"))
    with pytest.raises(LogError) as caught:
        all_parameters(read_configuration(path))
    text = str(caught.value).removeprefix(str(tmp_path))
    assert words in text and "\n" not in text and len(text) < 400


@pytest.mark.parametrize("step", ["1e-308", "5e-324", "-5e-324"])
@pytest.mark.parametrize("other", ["", "gear_ratio = 1e308", "scale = 1e-300"])
def test_a_step_far_below_any_encoder(step: str, other: str, tmp_path: Path) -> None:
    path = tmp_path / "log.toml"
    lines = f"[ports.theta]\nstep = {step}\n{other}\n"
    path.write_text(CONFIGURATION.replace("[ports.theta]\n", lines))
    with pytest.raises(LogError, match=r"ports\.theta\.step: expected at most"):
        all_parameters(read_configuration(path))


@pytest.mark.parametrize("row", ["", ",", " ", "\n\n"])
def test_a_table_of_a_head_units_and_a_blank_row(row: str, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(f"t,q\ns,rad\n{row}\n")
    with pytest.raises(LogError, match="expected rows below the column names, found none"):
        open_log(tmp_path / "log.csv")
