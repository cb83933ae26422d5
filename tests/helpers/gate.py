"""Programs that tests need beside a compiler, CMake, git and Python."""

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
    "c++": "g++",
    "cc": "gcc",
    "chromedriver": "chromium-driver",
    "clang++": "clang",
    "frama-c": "frama-c-base",
    "ip": "iproute2",
    "java": "default-jre-headless",
    "nsenter": "util-linux",
    "qemu-aarch64": "qemu-user",
    "sha256sum": "coreutils",
    "unshare": "util-linux",
}
"""Name of the Debian package, if it differs from the name of the program."""
_ALWAYS_THERE = {"c++", "cc", "g++", "gcc", "git", "sh", "wine64"}
"""A run of the gate has a minimal PATH, with Wine in its own folder, with CMake, but without make.
"""


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
    """Path of a program. Ends the test with the message `missing` if a program is not installed.

    Tests must find all programs with this function. The gate repeats the tests that need a tool,
    without the tools.

    folder  where the program may be besides the PATH
    """
    _note(name)
    found = shutil.which(name, path=os.pathsep.join(filter(None, (os.environ["PATH"], folder))))
    if found is None:
        missing(name, f"apt-get install {_PACKAGES.get(name, name)}")
    return found


def need_of_environment(name: str) -> str:
    """Path of a program of the Python environment. Ends the test without the program."""
    found = shutil.which(name, path=sysconfig.get_path("scripts"))
    if found is None:
        missing(f"{name} of the environment", "cmake --build build --target packages_test")
    return found


def note_program(event: str, arguments: tuple[object, ...]) -> None:
    """Records a test that starts a program by its name without a call of `need`; see
    sys.addaudithook.

    Without the program the test fails, and the gate shows this failure.
    """
    if event == "subprocess.Popen":
        _note(str(arguments[0]))


def _note(program: str) -> None:
    """Adds the name of the test to the file that SIGMAHAT_TOOLS names, if it needs a tool."""
    tests, test = os.environ.get("SIGMAHAT_TOOLS"), os.environ.get("PYTEST_CURRENT_TEST")
    if tests and test and program not in _ALWAYS_THERE and os.sep not in program:
        with Path(tests).open("a") as file:
            file.write(test.rpartition(" (")[0] + "\n")
