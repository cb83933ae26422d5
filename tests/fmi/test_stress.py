"""Races, leaks and undefined behaviour, found by sanitizers, also in random sequences of calls."""

import subprocess
from pathlib import Path

import pytest

from c_programs import compile_driver, compiler_with
from controllers import run
from fmi_functions import write_calls
from gate import need

# The versions of FMI share all code but their functions, and all FMUs the shell with its memory and
# locks: a model has no pointers. The fuzzer has the other models.
PAIR = [("StiffnessEstimator", "fmi2"), ("AwasPlant", "fmi3")]
FUZZED = [("AntagonisticStiffnessEstimator", "fmi2"), ("RealJointPlant", "fmi3")]
one_of_each_kind = pytest.mark.parametrize(("fmu", "version"), PAIR)
THREAD = ("-fsanitize=thread", "-pthread")
FUZZER = (
    "-fsanitize=fuzzer,address,undefined,float-cast-overflow",
    "-fno-sanitize-recover=all",
    "-DFUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION",
)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("drivers")


@one_of_each_kind
@pytest.mark.slow("many instances run side by side")
def test_instances_in_threads_do_not_influence_each_other(
    fmu: str, version: str, build: Path, folder: Path
) -> None:
    compiler = compiler_with(THREAD, folder)
    assert run(compile_driver("instances", fmu, version, build, folder, compiler, THREAD)) == ""


@pytest.mark.slow("valgrind executes the runs of some instances, tens of times slower")
@one_of_each_kind
def test_valgrind_finds_nothing(fmu: str, version: str, build: Path, folder: Path) -> None:
    valgrind = need("valgrind")
    flags = ("-pthread",)
    program = compile_driver(
        "instances", fmu, version, build, folder, compiler_with(flags, folder), flags
    )
    leaks = ["--leak-check=full", "--show-leak-kinds=all", "--errors-for-leak-kinds=all"]
    assert run(valgrind, "-q", "--error-exitcode=1", *leaks, program) == ""


@pytest.mark.slow("the fuzzer has a fixed time to try inputs")
def test_fuzzer_finds_nothing(build: Path, folder: Path) -> None:
    """An estimator and a plant at the same time, each in one version, for five seconds."""
    compiler = compiler_with(FUZZER, folder)
    # Long sequences from the first second on: short ones do not get far.
    lengths = ["-max_len=512", "-len_control=0"]
    options = ["-max_total_time=5", *lengths, "-timeout=20", f"-artifact_prefix={folder}/"]
    running = []
    for fmu, version in FUZZED:
        headers = folder / version
        headers.mkdir()
        write_calls(version, headers / "calls.h", left_out="FMU|DoStep")
        flags = (*FUZZER, f"-I{headers}")
        program = compile_driver("fuzz", fmu, version, build, folder, compiler, flags)
        command, quiet = [str(program), *options], subprocess.DEVNULL
        running.append(subprocess.Popen(command, stdout=quiet, stderr=subprocess.PIPE, text=True))
    for process in running:
        log = process.communicate()[1]
        assert process.returncode == 0, log[-10000:]
        assert "DONE" in log
