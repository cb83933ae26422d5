"""What `pip install .` installs, for somebody who has neither a compiler nor CMake."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import sysconfig
import zipfile
from pathlib import Path

import pytest

import sigmahat

REPOSITORY = Path(__file__).parents[2]
FMUS = {
    "StiffnessEstimator.fmu",
    "AntagonisticStiffnessEstimator.fmu",
    "AwasPlant.fmu",
    "FlexibleJointPlant.fmu",
    "AntagonisticVsaPlant.fmu",
}


def pip(*arguments: str | Path) -> None:
    """Without network: what is needed to build is in this environment."""
    done = subprocess.run(
        [sys.executable, "-m", "pip", *arguments, "--no-index", "--no-deps", "-q"],
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def sdist(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Source distribution."""
    folder = tmp_path_factory.mktemp("sdist")
    code = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
    subprocess.run([sys.executable, "-c", code, folder], cwd=REPOSITORY, check=True)
    (path,) = folder.iterdir()
    return path


@pytest.fixture(scope="module")
def wheel(sdist: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Wheel, built from the source distribution."""
    folder = tmp_path_factory.mktemp("wheel")
    pip("wheel", "--no-build-isolation", "-w", folder, sdist)
    (path,) = folder.iterdir()
    return path


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the programs of a new environment, with the wheel in it."""
    environment = tmp_path_factory.mktemp("environment")
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", environment], check=True)
    scheme = {"base": str(environment), "platbase": str(environment)}
    packages = Path(sysconfig.get_path("purelib", "venv", scheme))
    # Third-party packages are those of this environment; a .pth file there has no effect.
    (packages / "others.pth").write_text(sysconfig.get_path("purelib"))
    programs = Path(sysconfig.get_path("scripts", "venv", scheme))
    pip("--python", programs / "python", "install", wheel)
    return programs


def run(program: Path, *arguments: str, cwd: Path) -> str:
    """Runs a program with nothing else on the path."""
    done = subprocess.run(
        [program, *arguments],
        cwd=cwd,
        env={**os.environ, "PATH": str(program.parent)},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def test_wheel_is_for_the_platform_and_any_python(wheel: Path) -> None:
    name, version, python, abi, platform = wheel.stem.split("-")
    assert (name, version, python, abi) == ("sigmahat", sigmahat.__version__, "py3", "none")
    assert platform != "any"
    with zipfile.ZipFile(wheel) as archive:
        files = archive.namelist()
    in_folder = {Path(f).name for f in files if f.startswith("sigmahat/fmus/")}
    assert in_folder == {*FMUS, "sigmahat-awas.ssp"}
    assert "sigmahat/py.typed" in files
    assert {f.split("/")[0] for f in files} == {"sigmahat", f"{name}-{version}.dist-info"}


def test_no_compiler_is_reached_in_these_tests(installed: Path) -> None:
    for tool in ("cc", "gcc", "clang", "cmake", "ninja"):
        assert shutil.which(tool, path=str(installed)) is None


def test_fmu_is_that_of_the_installation(installed: Path, tmp_path: Path) -> None:
    code = "import sigmahat; print(sigmahat.__file__, *map(sigmahat.fmu, {!r}), sep='\\n')"
    names = sorted(Path(name).stem for name in FMUS)
    printed = run(installed / "python", "-c", code.format(names), cwd=tmp_path).splitlines()
    package = Path(printed[0]).parent
    assert package.is_relative_to(installed.parent)
    assert [Path(path).parent for path in printed[1:]] == [package / "fmus"] * len(FMUS)
    assert {Path(path).name for path in printed[1:] if Path(path).is_file()} == FMUS


def test_commands_give_what_the_development_tree_gives(installed: Path, tmp_path: Path) -> None:
    arguments = ("reproduce", "--scenario", "single-linear", "--json")
    printed = run(installed / "sigmahat", *arguments, cwd=tmp_path)
    assert "RESIDUAL" in printed
    assert printed == run(Path(sys.executable).with_name("sigmahat"), *arguments, cwd=tmp_path)


def test_types_are_those_of_the_sources(installed: Path, tmp_path: Path) -> None:
    program = tmp_path / "program.py"
    program.write_text("import sigmahat\nreveal_type(sigmahat.fmu)\nsigmahat.fmu(1)\n")
    done = subprocess.run(
        [sys.executable, "-m", "mypy", "--python-executable", installed / "python", program],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert 'Revealed type is "def (name: str) -> pathlib.Path"' in done.stdout
    assert 'Argument 1 to "fmu" has incompatible type "int"; expected "str"' in done.stdout
