"""Python environments of a stranger: empty, without a path of this repository."""

import os
import subprocess
import sys
from pathlib import Path

from gate import missing


def outside() -> dict[str, str]:
    """Returns the variables of a shell without paths of this repository and of its environment.

    pip does not compile modules, because the tests never import most of the modules.
    """
    own = Path(sys.executable).parent
    path = [p for p in os.environ["PATH"].split(os.pathsep) if Path(p) != own]
    kept = {k: v for k, v in os.environ.items() if not k.startswith(("PYTHON", "SIGMAHAT"))}
    return {**kept, "PATH": os.pathsep.join(path), "PIP_COMPILE": "0"}


def programs_of(folder: Path, *packages: str) -> Path:
    """Makes an environment, and installs packages with pip. Returns the folder of its programs."""
    subprocess.run([sys.executable, "-m", "venv", folder], env=outside(), check=True)
    programs = folder / Path(sys.executable).parent.name
    pip = [str(programs / "python"), "-m", "pip", "-q"]
    probe = [*pip, "download", "-d", str(folder / "probe"), "click"]
    if subprocess.run(probe, env=outside(), capture_output=True).returncode:
        missing("a connection to a package index", "connect this machine to one")
    install = [*pip, "install", *packages]
    done = subprocess.run(install, cwd=folder, env=outside(), capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return programs


def run_alone(program: Path, *arguments: str, cwd: Path) -> str:
    """Runs a program without other programs on the path, and returns its output."""
    environment = {**outside(), "PATH": str(program.parent)}
    command = [str(program), *arguments]
    done = subprocess.run(command, cwd=cwd, env=environment, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, ""), done.stdout + done.stderr
    return done.stdout
