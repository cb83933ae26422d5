"""Tools that check the archive and its model description find no error in the released FMUs."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest

from gate import missing, need
from released_fmus import FMUS, TWINS

each_fmu = pytest.mark.parametrize("name", FMUS)
each_version = pytest.mark.parametrize("name", FMUS + TWINS)


def output_of(command: list[str], cwd: Path | None = None) -> str:
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout + done.stderr


@each_version
def test_fmpy_finds_no_problem(name: str, released: Path) -> None:
    text = output_of([sys.executable, "-m", "fmpy", "validate", str(released / f"{name}.fmu")])
    assert text.strip() == "No problems found."


@each_version
def test_fmu_manipulation_toolbox_finds_no_error(name: str, released: Path) -> None:
    text = output_of(
        [
            *(sys.executable, "-m", "fmu_manipulation_toolbox.cli.fmutool"),
            *("-input", str(released / f"{name}.fmu"), "-check"),
        ]
    )
    version = 3 if name in TWINS else 2
    assert f"This FMU seems to be compliant with FMI-{version}.0." in text
    assert f"No semantic error against the FMI-{version} standard." in text
    assert "WARNING" not in text and "ERROR" not in text, text


@pytest.fixture(scope="module")
def vdmcheck(build: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with VDMCheck2, its libraries and its model, from which it can be run."""
    jars = build / "checkers" / "vdmcheck2"
    if not (jars / "vdmcheck2.jar").exists():
        missing("VDMCheck2", "mvn -f tests/checkers/pom.xml dependency:copy-dependencies")
    folder = tmp_path_factory.mktemp("vdmcheck2")
    for jar in jars.glob("*.jar"):
        shutil.copy(jar, folder)
    for jar_with_files in ("static-model.jar", "vdmcheck2.jar"):
        with ZipFile(folder / jar_with_files) as archive:
            archive.extractall(folder)
    return folder


@each_fmu
def test_vdmcheck2_finds_no_error(name: str, released: Path, vdmcheck: Path) -> None:
    text = output_of(
        [need("java"), "-jar", "vdmcheck2.jar", str(released.resolve() / f"{name}.fmu")],
        cwd=vdmcheck,
    )
    # VDMCheck2 names files of FMI 3 that are missing; an FMU of FMI 2.0 need not have them.
    lines = [line for line in text.splitlines() if not line.startswith("FMU has no ")]
    assert lines[-1] == "No errors found."
    assert all(line == "Checking modelDescription.xml" for line in lines[:-1]), text
