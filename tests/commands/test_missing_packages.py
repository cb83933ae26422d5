"""If a package is missing, the error is one line that names the package and how to install it."""

import shlex
import subprocess
import sys
from pathlib import Path

import pytest

from command_line import one_line
from sender import CONFIGURATION

WITHOUT = """
import sys
from sigmahat.cli import main

class Without:
    def find_spec(name, path, target=None):
        if name == sys.argv[1]:
            raise ModuleNotFoundError(f"No module named {name!r}", name=name)

sys.meta_path.insert(0, Without)
"""


def run_without(
    module: str, *arguments: str, cwd: Path, program: str = "sys.exit(main(sys.argv[2:]))"
) -> subprocess.CompletedProcess[str]:
    """Runs a command of sigmahat, or another program, as if a module were not installed."""
    command = [sys.executable, "-c", WITHOUT + program, module, *arguments]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True)


@pytest.mark.parametrize(
    ("package", "arguments", "wanted"),
    [
        ("scipy", "reproduce --seeds 2", "sigmahat"),
        ("pyarrow", "sweep", "sigmahat"),
        ("tomlkit", "identify log.csv", "sigmahat"),
        ("bokeh", "report .", "sigmahat"),
        ("distributed", "sweep --scheduler tcp://localhost:1", "sigmahat[dask]"),
        ("h5py", "estimate log.h5", "sigmahat[hdf5]"),
        ("rosbags", "init log.mcap", "sigmahat[bags]"),
        ("mcap", "estimate log.csv --config log.toml --to mcap", "sigmahat[mcap]"),
        ("cyclonedds", "live log.toml --from ros2", "sigmahat[ros2]"),
        ("foxglove", "live log.toml --to foxglove", "sigmahat[foxglove]"),
    ],
)
def test_one_line_says_what_to_install(
    package: str, arguments: str, wanted: str, tmp_path: Path
) -> None:
    (tmp_path / "log.h5").write_bytes(b"\x89HDF\r\n\x1a\n")
    (tmp_path / "log.mcap").write_bytes(b"\x89MCAP0\r\n")
    (tmp_path / "log.toml").write_text(CONFIGURATION)
    line = one_line(run_without(package, *arguments.split(), cwd=tmp_path))
    command = shlex.join([sys.executable, "-m", "pip", "install", wanted])
    distribution = {"foxglove": "foxglove-sdk"}.get(package, package)
    assert line == f"sigmahat: error: {distribution} is not installed; to install it: {command}"


def test_what_sigmahat_does_not_require_is_a_fault_that_shows(tmp_path: Path) -> None:
    done = run_without("sigmahat.studies.reproduce", "reproduce", cwd=tmp_path)
    assert done.returncode == 1
    assert "ModuleNotFoundError" in done.stderr


@pytest.mark.parametrize("name", ["encoder", "PlantEquations", "write_plant_fmu"])
def test_a_public_name_says_what_to_install(name: str, tmp_path: Path) -> None:
    done = run_without("casadi", cwd=tmp_path, program=f"from sigmahat import {name}")
    install = shlex.join([sys.executable, "-m", "pip", "install", "sigmahat[plants]"])
    *_, line = done.stderr.splitlines()
    assert line == f"ModuleNotFoundError: casadi is not installed; to install it: {install}"
