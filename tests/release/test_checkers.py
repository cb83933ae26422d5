"""Tools that check the archive and its model description find no error in the released FMUs."""

import shutil
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest
from fmpy.validation import validate_fmu
from fmu_manipulation_toolbox.cli.fmutool import fmutool

from controllers import run
from gate import missing, need
from released_fmus import FMUS, TWINS


@pytest.mark.parametrize("name", FMUS + TWINS)
def test_fmpy_and_the_manipulation_toolbox_find_no_error(
    name: str,
    released: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    fmu = str(released / f"{name}.fmu")
    assert validate_fmu(fmu) == []
    monkeypatch.setattr(sys, "argv", ["fmutool", "-input", fmu, "-check"])
    fmutool()
    text = "".join(capsys.readouterr())
    version = 3 if name in TWINS else 2
    assert f"This FMU seems to be compliant with FMI-{version}.0." in text
    assert f"No semantic error against the FMI-{version} standard." in text
    assert "WARNING" not in text and "ERROR" not in text, text


@pytest.mark.parametrize("name", ["AntagonisticStiffnessEstimator", "RealJointPlant"])
def test_vdmcheck2_finds_no_error(name: str, released: Path, build: Path, tmp_path: Path) -> None:
    jars = build / "checkers" / "vdmcheck2"
    if not (jars / "vdmcheck2.jar").exists():
        missing("VDMCheck2", "mvn -f tests/checkers/pom.xml dependency:copy-dependencies")
    for jar in jars.glob("*.jar"):
        shutil.copy(jar, tmp_path)
    for jar_with_files in ("static-model.jar", "vdmcheck2.jar"):  # it runs from their folder
        with ZipFile(jars / jar_with_files) as archive:
            archive.extractall(tmp_path)
    fmu = released.resolve() / f"{name}.fmu"
    text = run(need("java"), "-jar", "vdmcheck2.jar", fmu, cwd=tmp_path)
    # VDMCheck2 names files of FMI 3 that are missing; an FMU of FMI 2.0 need not have them.
    lines = [line for line in text.splitlines() if not line.startswith("FMU has no ")]
    assert lines[-1] == "No errors found."
    assert all(line == "Checking modelDescription.xml" for line in lines[:-1]), text
