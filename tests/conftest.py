"""Paths of the build for the tests, and which tests run first."""

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
    """Build tree, from SIGMAHAT_BUILD or ``build`` in the checkout."""
    return Path(os.environ.get("SIGMAHAT_BUILD", Path(__file__).parent.parent / "build"))


@pytest.fixture(scope="session")
def c(build: Path) -> "Library":
    """The library in C, which the environment of `reproduce` cannot call."""
    from c_library import load

    return load(build)


@pytest.fixture(scope="session")
def fmi3(build: Path) -> Fmi:
    """The FMUs for FMI 3.0, with the binary of this machine."""
    return Fmi(Instance3, lambda name: build / "fmi3" / f"{name}_FMI3.fmu")


@pytest.fixture(params=["fmi2", "fmi3"])
def fmi(request: pytest.FixtureRequest, fmi3: Fmi) -> Fmi:
    """Each version of FMI in turn."""
    return FMI2 if request.param == "fmi2" else fmi3


@pytest.fixture(scope="session")
def released(build: Path) -> Path:
    """Folder of the FMUs as ``cmake --workflow --preset release`` makes them."""
    folder = build / "release"
    if not folder.is_dir():
        pytest.fail("there is no release to test; make it: cmake --workflow --preset release")
    return folder


@pytest.fixture(scope="session")
def site(build: Path) -> Path:
    """Folder of the documentation as ``cmake --workflow --preset docs`` makes it."""
    folder = build / "site"
    if not (folder / "index.html").is_file():
        pytest.fail("there is no site to test; make it: cmake --workflow --preset docs")
    return folder


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skips what the preset `complete` runs.

    In several processes, the files with slow tests come first: a long one at the end would leave
    the other processes without work.
    """
    slow_files = {item.path for item in items if item.get_closest_marker("slow")}
    for item in items:
        if item.get_closest_marker("complete") and "SIGMAHAT_COMPLETE" not in os.environ:
            item.add_marker(pytest.mark.skip(reason="runs with SIGMAHAT_COMPLETE=1"))
    if hasattr(config, "workerinput"):  # one of the processes of pytest-xdist
        items.sort(key=lambda item: item.path not in slow_files)
