"""pip installs a fresh clone into an empty environment, which is used from another folder.

No search path of the tested programs contains a folder of this repository.
"""

import sys
import tarfile
from pathlib import Path

import pytest

import controllers
import sigmahat
from clean_environment import programs_of, run_alone
from gate import need
from recorded_logs import CONFIGURATION, awas_log, write_log
from released_fmus import FMUS

REPOSITORY = Path(__file__).parents[2]
pytestmark = pytest.mark.slow(
    "pip fetches what building needs, builds the package, and installs it with all that it requires"
)


@pytest.fixture(scope="module")
def clone(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with a fresh clone of the last commit."""
    folder = tmp_path_factory.mktemp("clone") / "sigmahat"
    controllers.run(need("git"), "clone", "-q", REPOSITORY, folder)
    return folder


@pytest.fixture(scope="module")
def programs(clone: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with the programs of an environment into which pip has installed the clone."""
    return programs_of(tmp_path_factory.mktemp("installed"), str(clone))


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
    """The test ensures that the source distribution builds if the clone builds."""
    code = "import sys; from scikit_build_core.build import build_sdist; build_sdist(sys.argv[1])"
    controllers.run(sys.executable, "-c", code, tmp_path, cwd=clone)
    (path,) = tmp_path.iterdir()
    with tarfile.open(path) as archive:
        files = {name.split("/", 1)[1] for name in archive.getnames()}
    tracked = controllers.run(need("git"), "ls-files", cwd=clone).splitlines()
    assert files == {*tracked, "PKG-INFO"}


def test_commands_give_what_the_development_tree_gives(programs: Path, tmp_path: Path) -> None:
    arguments = ("reproduce", "--scenario", "single-linear", "--seeds", "2", "--json")
    printed = run_alone(programs / "sigmahat", *arguments, cwd=tmp_path)
    assert "RESIDUAL" in printed
    assert printed == run_alone(
        Path(sys.executable).with_name("sigmahat"), *arguments, cwd=tmp_path
    )


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
        assert run_alone(programs / "sigmahat", *command.split(), cwd=tmp_path)
