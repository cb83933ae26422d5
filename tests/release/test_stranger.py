"""What a stranger does with the files of a release, and with nothing else of this project."""

import json
import re
import shutil
import sys
from pathlib import Path
from zipfile import ZipFile

import pytest

import sigmahat
from clean_environment import programs_of, run_alone

REPOSITORY = Path(__file__).parents[2]
TUTORIAL = REPOSITORY / "examples" / "tutorial"
pytestmark = [
    pytest.mark.slow("pip installs the wheel with all that it requires, and builds the sources"),
    pytest.mark.skipif(not sys.platform.startswith("linux"), reason="the wheel of this machine"),
]


@pytest.fixture(scope="module")
def programs(released: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Programs of an environment into which pip has installed the wheel of the release."""
    name = f"sigmahat-{sigmahat.__version__}-py3-none-manylinux_2_17_x86_64.whl"
    return programs_of(tmp_path_factory.mktemp("wheel"), str(released / "python" / name))


def follow_the_tutorial(programs: Path, folder: Path) -> None:
    """The true stiffness in the second half of the log is from 300 to 395 N.m/rad."""
    for file in ("knee.csv", "knee.toml"):
        shutil.copy(TUTORIAL / file, folder)
    run_alone(programs / "sigmahat", "identify", "knee.csv", "--quiet", cwd=folder)
    estimate = ("estimate", "knee.csv", "--json")
    found = json.loads(run_alone(programs / "sigmahat", *estimate, cwd=folder))
    assert found["confident"] == 1.0
    assert found["sigma_range"] == pytest.approx([300.0, 395.0], rel=0.02)


def test_the_wheel_gives_the_answer_of_the_tutorial(programs: Path, tmp_path: Path) -> None:
    follow_the_tutorial(programs, tmp_path)


@pytest.mark.complete  # test_install.py builds a clone, which holds the same files
def test_the_source_distribution_builds_and_gives_it_too(
    released: Path, tmp_path_factory: pytest.TempPathFactory, tmp_path: Path
) -> None:
    sources = released / "python" / f"sigmahat-{sigmahat.__version__}.tar.gz"
    built = programs_of(tmp_path_factory.mktemp("sources"), str(sources))
    follow_the_tutorial(built, tmp_path)


@pytest.mark.parametrize("version", ["", "_FMI3"])
def test_an_fmu_runs_with_fmpy_alone(
    version: str, released: Path, programs: Path, tmp_path: Path
) -> None:
    """GIVEN the program of the page on FMUs, with the path of a file in place of the package."""
    shutil.copy(released / f"StiffnessEstimator{version}.fmu", tmp_path / "estimator.fmu")
    page = (REPOSITORY / "docs" / "fmu.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"^```python\n(.*?)^```$", page, re.MULTILINE | re.DOTALL)
    code = code.replace("import sigmahat\n", "")
    code = code.replace('sigmahat.fmu("StiffnessEstimator")', '"estimator.fmu"')
    assert "sigmahat" not in code
    printed = run_alone(programs / "python", "-c", code, cwd=tmp_path)
    assert float(printed.split()[0]) == pytest.approx(1000.0, rel=1e-3)


def test_the_modelica_package_is_whole(released: Path) -> None:
    with ZipFile(released / "sigmahat-modelica.zip") as archive:
        names = archive.namelist()
        folder = f"Sigmahat {sigmahat.__version__}"
        package = archive.read(f"{folder}/package.mo").decode()
        order = archive.read(f"{folder}/package.order").decode().split()
    assert f'version="{sigmahat.__version__}"' in package.replace(" ", "")
    for name in order:
        assert any(n.startswith((f"{folder}/{name}/", f"{folder}/{name}.mo")) for n in names), name
    assert any(name.endswith("sigmahat.c") for name in names)
