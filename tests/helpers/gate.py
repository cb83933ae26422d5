"""Programs that tests need beside a compiler, CMake, git and Python."""

from __future__ import annotations

import os
import shutil
import sysconfig
from pathlib import Path
from typing import NoReturn

import pytest

_PACKAGES = {
    "aarch64-linux-gnu-gcc": "gcc-aarch64-linux-gnu libc6-dev-arm64-cross",
    "arm-none-eabi-gcc": "gcc-arm-none-eabi libnewlib-arm-none-eabi",
    "arm-none-eabi-nm": "binutils-arm-none-eabi",
    "arm-none-eabi-objdump": "binutils-arm-none-eabi",
    "bash": "bash",
    "c++": "g++",
    "cc": "gcc",
    "chromedriver": "chromium-driver",
    "chromium": "chromium",
    "clang": "clang",
    "clang++": "clang",
    "clang-tidy": "clang-tidy",
    "cppcheck": "cppcheck",
    "frama-c": "frama-c-base",
    "g++": "g++",
    "gcc": "gcc",
    "git": "git",
    "java": "default-jre-headless",
    "pkg-config": "pkg-config",
    "qemu-aarch64": "qemu-user",
    "qemu-system-arm": "qemu-system-arm",
    "sha256sum": "coreutils",
    "valgrind": "valgrind",
    "wine64": "wine64",
}
_ALWAYS_THERE = {"bash", "c++", "cc", "g++", "gcc", "git", "sha256sum"}
"""In the run of the gate with a bare PATH."""


def missing(what: str, how: str) -> NoReturn:
    """Ends the test: skips it. In the gate, which sets SIGMAHAT_GATE, the test fails instead.

    what  the tool, as in "<what> is not installed"
    how   command that installs it
    """
    text = f"{what} is not installed; to install it: {how}"
    if os.environ.get("SIGMAHAT_GATE"):
        pytest.fail(text)
    pytest.skip(text)


def need(name: str, folder: str = "") -> str:
    """Path of a program. Ends the test with `missing` if it is not installed.

    Tests call no program past this function. It adds the name of the test to the file that
    SIGMAHAT_TOOLS names, so that the gate can run the test again without the program.

    folder  where the program may be besides the PATH
    """
    if name not in _ALWAYS_THERE:
        _note_test()
    found = shutil.which(name, path=os.pathsep.join(filter(None, (os.environ["PATH"], folder))))
    if found is None:
        missing(name, f"apt-get install {_PACKAGES[name]}")
    return found


def need_of_environment(name: str) -> str:
    """Path of a program of the Python environment. Ends the test if it is not installed."""
    found = shutil.which(name, path=sysconfig.get_path("scripts"))
    if found is None:
        missing(f"{name} of the environment", "cmake --build build --target packages_test")
    return found


def is_installed(name: str) -> bool:
    """Whether a program is there, for tests that can use another one instead."""
    return shutil.which(name) is not None


def _note_test() -> None:
    list_of_tests = os.environ.get("SIGMAHAT_TOOLS")
    if list_of_tests:
        with Path(list_of_tests).open("a") as file:
            file.write(os.environ["PYTEST_CURRENT_TEST"].rpartition(" (")[0] + "\n")
