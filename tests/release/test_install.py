"""The package that pip builds from a fresh clone, in an empty environment and another folder.

Nothing of this tree is on a path of what runs here.
"""

import os
import subprocess
import sys
import tarfile
from pathlib import Path

import pytest

import controllers
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


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Fresh clone of what is committed."""
    folder = tmp_path_factory.mktemp("clone") / "sigmahat"
    controllers.run(need("git"), "clone", "-q", REPOSITORY, folder)
    return folder


@pytest.fixture(scope="module")
def programs(clone: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Programs of an environment into which pip installed the clone."""
    folder = tmp_path_factory.mktemp("installed")
    subprocess.run([sys.executable, "-m", "venv", folder], env=outside(), check=True)
    programs = folder / Path(sys.executable).parent.name
    pip = [str(programs / "python"), "-m", "pip", "-q"]
    probe = [*pip, "download", "-d", str(folder / "probe"), "click"]
    if subprocess.run(probe, env=outside(), capture_output=True).returncode:
        missing("a connection to a package index", "connect this machine to one")
    install = [*pip, "install", str(clone)]
    done = subprocess.run(install, cwd=folder, env=outside(), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return programs


def run(program: Path, *arguments: str, cwd: Path) -> str:
    """Output of a program with nothing else on the path, and no error."""
    environment = {**outside(), "PATH": str(program.parent)}
    command = [str(program), *arguments]
    done = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout + done.stderr
    return done.stdout


def test_the_package_is_for_the_platform_and_any_python(programs: Path) -> None:
    (described,) = programs.parent.rglob(f"sigmahat-{sigmahat.__version__}.dist-info")
    (tag,) = (t for t in (described / "WHEEL").read_text().splitlines() if t.startswith("Tag: "))
    assert tag.startswith("Tag: py3-none-") and not tag.endswith("-any")
    package = described.with_name("sigmahat")
    assert (package / "py.typed").is_file()
    in_folder = {path.name for path in (package / "fmus").iterdir()}
    native = {f"sigmahat_native{extension}" for extension in (".so", ".dll", ".dylib")}
    assert len(in_folder & native) == 1
    assert in_folder - native == {*(f"{name}.fmu" for name in FMUS), "sigmahat-awas.ssp"}
    files = [line.split(",")[0] for line in (described / "RECORD").read_text().splitlines()]
    others = [f for f in files if not f.startswith(("sigmahat/", f"{described.name}/"))]
    assert [Path(file).stem for file in others] == ["sigmahat"]  # the command


def test_source_distribution_holds_what_git_holds(clone: Path, tmp_path: Path) -> None:
    """So it builds if the clone does."""
    code = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
    controllers.run(sys.executable, "-c", code, tmp_path, cwd=clone)
    (path,) = tmp_path.iterdir()
    with tarfile.open(path) as archive:
        files = {name.split("/", 1)[1] for name in archive.getnames()}
    tracked = controllers.run(need("git"), "ls-files", cwd=clone).splitlines()
    assert files == {*tracked, "PKG-INFO"}


def test_commands_give_what_the_development_tree_gives(programs: Path, tmp_path: Path) -> None:
    arguments = ("reproduce", "--scenario", "single-linear", "--seeds", "2", "--json")
    printed = run(programs / "sigmahat", *arguments, cwd=tmp_path)
    assert "RESIDUAL" in printed
    assert printed == run(Path(sys.executable).with_name("sigmahat"), *arguments, cwd=tmp_path)


def test_every_command_has_what_it_needs(programs: Path, tmp_path: Path) -> None:
    log = awas_log(1.0, 0.3, duration=4.0)
    del log["true"]
    write_log(log, tmp_path / "a.csv", CONFIGURATION)
    for command in (
        "init a.csv --config guessed.toml",
        "identify a.csv",
        "estimate a.csv",
        "report sigmahat-results/a",
        "scenarios",
        "sweep --scenario single-linear --out sweep",
        "report sweep",
    ):
        assert run(programs / "sigmahat", *command.split(), cwd=tmp_path)
