"""What pip makes of a fresh clone, in environments with nothing else, used from another folder.

`pip wheel .` is the first half of `pip install .`, and the installation of its wheels the second.
Nothing of this tree is on a path of what runs here.
"""

from __future__ import annotations

import os
import subprocess
import sys
import sysconfig
import tarfile
import zipfile
from pathlib import Path

import pytest

import sigmahat
from gate import missing, need
from recorded_logs import CONFIGURATION, awas_log, write_log
from released_fmus import FMUS

REPOSITORY = Path(__file__).parents[2]
pytestmark = pytest.mark.slow(
    "pip fetches what building needs, builds the package, and installs it with all that it requires"
)


def outside() -> dict[str, str]:
    """Variables of a shell that knows nothing of this tree, nor of the environment of the tests.

    pip does not compile modules of which most are never imported here.
    """
    own = Path(sys.executable).parent
    path = [p for p in os.environ["PATH"].split(os.pathsep) if Path(p) != own]
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "SIGMAHAT"))}
    return {**kept, "PATH": os.pathsep.join(path), "PIP_COMPILE": "0"}


def new_environment(folder: Path, *options: str) -> Path:
    """The folder of the programs of a new environment, with pip and nothing else."""
    subprocess.run([sys.executable, "-m", "venv", *options, folder], env=outside(), check=True)
    scheme = {"base": str(folder), "platbase": str(folder)}
    return Path(sysconfig.get_path("scripts", "venv", scheme))


def pip(programs: Path, *arguments: str | Path) -> None:
    """Runs pip of an environment, in its folder."""
    done = subprocess.run(
        [programs / "python", "-m", "pip", *arguments, "-q"],
        cwd=programs,
        env=outside(),
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stdout + done.stderr


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Fresh clone of what is committed."""
    folder = tmp_path_factory.mktemp("clone") / "sigmahat"
    subprocess.run([need("git"), "clone", "-q", REPOSITORY, folder], check=True)
    return folder


@pytest.fixture(scope="module")
def empty(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Programs of an environment with pip and nothing else."""
    return new_environment(tmp_path_factory.mktemp("empty"))


@pytest.fixture(scope="module")
def wheels(clone: Path, empty: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder of the wheel built from the clone, and of those that it requires."""
    folder = tmp_path_factory.mktemp("wheels")
    probe: list[str | Path] = [empty / "python", "-m", "pip", "download", "-d", folder, "click"]
    if subprocess.run(probe, env=outside(), capture_output=True).returncode:
        missing("a connection to a package index", "connect this machine to one")
    pip(empty, "wheel", clone, "-w", folder)
    return folder


@pytest.fixture(scope="module")
def wheel(wheels: Path) -> Path:
    (path,) = wheels.glob("sigmahat-*.whl")
    return path


@pytest.fixture(scope="module")
def installed(wheels: Path, empty: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Programs of an environment with the wheel, and with those that it requires."""
    programs = new_environment(tmp_path_factory.mktemp("installed"), "--without-pip")
    into = ("--python", programs / "python")
    pip(empty, *into, "install", "--no-index", "--find-links", wheels, "sigmahat")
    return programs


def run(program: Path, *arguments: str, cwd: Path, status: int = 0) -> str:
    """What a program prints with nothing else on the path: stdout, or stderr if it has to fail."""
    done = subprocess.run(
        [program, *arguments],
        cwd=cwd,
        env={**outside(), "PATH": str(program.parent)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == status, done.stdout + done.stderr
    printed, empty = (done.stderr, done.stdout) if status else (done.stdout, done.stderr)
    assert empty == ""
    return printed


def test_wheel_is_for_the_platform_and_any_python(wheel: Path) -> None:
    name, version, python, abi, platform = wheel.stem.split("-")
    assert (name, version, python, abi) == ("sigmahat", sigmahat.__version__, "py3", "none")
    assert platform != "any"
    with zipfile.ZipFile(wheel) as archive:
        files = archive.namelist()
    in_folder = {Path(f).name for f in files if f.startswith("sigmahat/fmus/")}
    native = {f"sigmahat_native{extension}" for extension in (".so", ".dll", ".dylib")}
    assert len(in_folder & native) == 1
    assert in_folder - native == {*(f"{name}.fmu" for name in FMUS), "sigmahat-awas.ssp"}
    assert "sigmahat/py.typed" in files
    assert {f.split("/")[0] for f in files} == {"sigmahat", f"{name}-{version}.dist-info"}


def test_source_distribution_holds_what_git_holds(clone: Path, tmp_path: Path) -> None:
    """So it builds if the clone does."""
    code = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
    subprocess.run([sys.executable, "-c", code, tmp_path], cwd=clone, check=True)
    (path,) = tmp_path.iterdir()
    with tarfile.open(path) as archive:
        files = {name.split("/", 1)[1] for name in archive.getnames()}
    tracked = subprocess.run(
        [need("git"), "ls-files", "-z"], cwd=clone, capture_output=True, text=True, check=True
    ).stdout.split("\0")
    assert files == {*tracked, "PKG-INFO"} - {""}


def test_commands_give_what_the_development_tree_gives(installed: Path, tmp_path: Path) -> None:
    arguments = ("reproduce", "--scenario", "single-linear", "--seeds", "2", "--json")
    printed = run(installed / "sigmahat", *arguments, cwd=tmp_path)
    assert "RESIDUAL" in printed
    assert printed == run(Path(sys.executable).with_name("sigmahat"), *arguments, cwd=tmp_path)


def test_every_command_has_what_it_needs(installed: Path, tmp_path: Path) -> None:
    log = awas_log(1.0, 0.3, duration=4.0)
    del log["true"]
    write_log(log, tmp_path / "a.csv")
    (tmp_path / "a.toml").write_text(CONFIGURATION, encoding="utf-8")
    for command in (
        "init a.csv --config guessed.toml",
        "identify a.csv",
        "estimate a.csv",
        "report sigmahat-results/a",
        "scenarios",
        "sweep --scenario single-linear --out sweep",
        "report sweep",
    ):
        assert run(installed / "sigmahat", *command.split(), cwd=tmp_path)
