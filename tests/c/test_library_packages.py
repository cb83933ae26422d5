"""The C library in a program of a user: find_package, pkg-config, a pair of files, Conan."""

import os
import re
import shlex
import shutil
import subprocess
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from c_library import Estimator, load, type_of_estimate
from c_sources import REPOSITORY
from controllers import HOST, cross_build, run
from gate import need, need_of_environment
from reference_joints import table1_recording

WARNINGS = ["-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Werror"]
PROGRAM = REPOSITORY / "tests" / "replay" / "replay.c"
PROJECT = """
cmake_minimum_required(VERSION 3.25)
project(consumer LANGUAGES C)
find_package(sigmahat 1.0 REQUIRED)
add_executable(consumer replay.c)
target_link_libraries(consumer PRIVATE sigmahat::sigmahat)
"""


def check(program: Path, build: Path, real: str, folder: Path) -> None:
    """Checks that the program gives the result of the library, in double to the last bit."""
    log = table1_recording().measurements()[:2000].copy()
    log.tofile(folder / "log")
    run(program, folder / "log", folder / "out", "a")
    sigma = np.fromfile(folder / "out", type_of_estimate(build, real))["sigma"][-1]
    expected = Estimator(load(build), {}).run(log)["sigma"][-1]
    assert sigma == (expected if real == "double" else pytest.approx(expected, rel=1e-3))


@pytest.fixture(scope="module", params=["double", "float"])
def installed(
    request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory
) -> tuple[Path, str]:
    """Folder to which the installed library was moved, and the type of its numbers."""
    folder = tmp_path_factory.mktemp(f"installed-{request.param}")
    tree = cross_build("c", HOST, request.param, folder)
    run("cmake", "--install", tree, "--prefix", folder / "first")
    return (folder / "first").rename(folder / "moved"), request.param


def test_find_package_finds_the_installed_library(
    installed: tuple[Path, str], build: Path, tmp_path: Path
) -> None:
    prefix, real = installed
    shutil.copy(PROGRAM, tmp_path)
    (tmp_path / "CMakeLists.txt").write_text(PROJECT)
    tree = cross_build(str(tmp_path), HOST, real, tmp_path, (f"CMAKE_PREFIX_PATH={prefix}",))
    check(tree / "consumer", build, real, tmp_path)


def test_pkg_config_describes_the_installed_library(
    installed: tuple[Path, str], build: Path, tmp_path: Path
) -> None:
    prefix, real = installed
    (described,) = prefix.rglob("sigmahat.pc")
    flags = run(
        *(need("pkg-config"), "--cflags", "--libs", "sigmahat"),
        environment={"PKG_CONFIG_PATH": str(described.parent)},
    )
    run(need("cc"), PROGRAM, "-o", tmp_path / "consumer", *shlex.split(flags))
    check(tmp_path / "consumer", build, real, tmp_path)


@pytest.mark.parametrize(
    ("c", "cpp", "real"), [("gcc", "g++", "double"), ("clang", "clang++", "float")]
)
def test_the_pair_of_files_works_in_c_and_cpp(
    c: str, cpp: str, real: str, build: Path, tmp_path: Path
) -> None:
    """The files compile alone and without a warning, and the header can be used in C and C++."""
    flags = ["-O2", "-ffp-contract=off", *WARNINGS, f"-DSH_REAL={real}"]
    if real == "float":
        flags += ["-Wdouble-promotion", "-Wfloat-conversion"]
    for file in ("sigmahat.c", "sigmahat.h"):
        shutil.copy(build / "amalgamation" / file, tmp_path)
    library = tmp_path / "sigmahat.o"
    alone = ["-std=c99", "-ffreestanding", *flags]
    run(need(c), *alone, "-c", tmp_path / "sigmahat.c", "-o", library)
    for compiler, options, file in (
        (need(c), ["-std=c99", "-Wno-double-promotion"], "main.c"),
        (need(cpp), ["-Wno-double-promotion"], "main.cpp"),
    ):
        shutil.copy(PROGRAM, tmp_path / file)
        program = tmp_path / f"{file}.exe"
        run(compiler, *flags, *options, tmp_path / file, library, "-lm", "-o", program)
        check(program, build, real, tmp_path)


@pytest.mark.parametrize(("compiler", "file"), [("cc", "main.c"), ("c++", "main.cpp")])
def test_a_program_of_other_sizes_than_the_library_does_not_link(
    compiler: str, file: str, build: Path, tmp_path: Path
) -> None:
    """The linker names the function with the sizes that the program expects."""
    sources, library = build / "amalgamation", tmp_path / "sigmahat.o"
    run(need("cc"), "-c", sources / "sigmahat.c", "-o", library)
    shutil.copy(PROGRAM, tmp_path / file)
    for size in ("SH_REAL=float", "SH_MAX_N=4", "SH_MAX_M=1", "SH_MAX_COLUMNS=21"):
        command = [need(compiler), f"-D{size}", f"-I{sources}", str(tmp_path / file), str(library)]
        done = subprocess.run(
            [*command, "-lm", "-o", tmp_path / "program"], capture_output=True, text=True
        )
        assert done.returncode != 0
        (name,) = set(re.findall(r"\bsh_estimator_start\w+", done.stderr))
        assert f"_{size.partition('=')[2]}" in name


@pytest.fixture(scope="module")
def conan(build: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., str]:
    """Conan of the environment, with a cache of its own that is empty."""
    program, home = need_of_environment("conan"), str(tmp_path_factory.mktemp("conan"))
    path = f"{build / 'venv' / 'bin'}{os.pathsep}{os.environ['PATH']}"  # for Ninja
    places = {"CONAN_HOME": home, "PATH": path, "TMP": home, "TMPDIR": home}
    run(program, "profile", "detect", environment=places)
    return partial(run, program, environment=places)


@pytest.mark.complete
@pytest.mark.parametrize(
    ("options", "number", "least", "most"),
    [
        ((), 8, 100_000, 160_000),
        (("real=float", "max_n=2", "max_m=1", "max_columns=1"), 4, 500, 1500),
    ],
    ids=["double", "float, small"],
)
def test_conan_creates_the_package_and_its_program_runs(
    options: tuple[str, ...], number: int, least: int, most: int, conan: Callable[..., str]
) -> None:
    """Uses these options of the recipe."""
    text = conan(
        *("create", REPOSITORY / "c", "--no-remote"),
        *(part for option in options for part in ("-o", f"sigmahat/*:{option}")),
        *("-c", "tools.cmake.cmaketoolchain:generator=Ninja"),
        *("-c", "tools.cmake.cmake_layout:test_folder=$TMP"),
    )
    printed = re.search(r"sigma = (\S+) N.m/rad; a number has (\d+) bytes, an instance (\d+)", text)
    assert printed, text
    assert float(printed[1]) == pytest.approx(150.0, rel=1e-4)
    assert int(printed[2]) == number
    assert least < int(printed[3]) < most
