"""Fixtures with the paths of build products, and the order in which tests run."""

import os
import sys
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

import gate
from command_line import shell as shell
from fmi_instance import Instance3
from fmi_runs import FMI2, Fmi

if TYPE_CHECKING:
    from c_library import Library

if "SIGMAHAT_TOOLS" in os.environ:
    sys.addaudithook(gate.note_program)


@pytest.fixture(scope="session")
def build() -> Path:
    """Path of the build tree: the variable SIGMAHAT_BUILD, or ``build`` in the repository."""
    return Path(os.environ.get("SIGMAHAT_BUILD", Path(__file__).parent.parent / "build"))


@pytest.fixture(scope="session")
def c(build: Path) -> "Library":
    """The C library as a Python object, which the environment of `reproduce` cannot load."""
    from c_library import load

    return load(build)


@pytest.fixture(scope="session")
def fmi3(build: Path) -> Fmi:
    """Loader of the FMUs for FMI 3.0, with the binary of this machine."""
    return Fmi(Instance3, lambda name: build / "fmi3" / f"{name}_FMI3.fmu")


@pytest.fixture(params=["fmi2", "fmi3"])
def fmi(request: pytest.FixtureRequest, fmi3: Fmi) -> Fmi:
    """Loader of the FMUs for FMI 2.0, then for FMI 3.0."""
    return FMI2 if request.param == "fmi2" else fmi3


@pytest.fixture(scope="session")
def released(build: Path) -> Path:
    """Folder with the released FMUs, which ``cmake --workflow --preset release`` builds."""
    folder = build / "release"
    if not folder.is_dir():
        pytest.fail("there is no release to test; make it: cmake --workflow --preset release")
    return folder


@pytest.fixture(scope="session")
def site(build: Path) -> Path:
    """Folder of the HTML documentation, which ``cmake --workflow --preset docs`` builds."""
    folder = build / "site"
    if not (folder / "index.html").is_file():
        pytest.fail("there is no site to test; make it: cmake --workflow --preset docs")
    return folder


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skips the slow tests, which only the preset `complete` runs.

    If several processes run the tests, files with slow tests come first. A slow test at the end
    would leave the other processes idle.
    """
    slow_files = {item.path for item in items if item.get_closest_marker("slow")}
    for item in items:
        if item.get_closest_marker("complete") and "SIGMAHAT_COMPLETE" not in os.environ:
            item.add_marker(pytest.mark.skip(reason="runs with SIGMAHAT_COMPLETE=1"))
    if hasattr(config, "workerinput"):  # in a worker process of pytest-xdist
        items.sort(key=lambda item: item.path not in slow_files)
