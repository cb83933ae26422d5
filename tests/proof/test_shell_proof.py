"""The shell of the FMUs, proven by Frama-C Eva: saved states, value references, instances.

The programs `shell_*.c` call the shell as an importer may; docs/proof/shell.md says what they
cover.
"""

import re
from collections.abc import Mapping, Sequence
from pathlib import Path

import pytest

from c_sources import REPOSITORY
from eva import analyse, library_source, with_fault
from fmi_functions import HEADERS, write_calls

PROOF = REPOSITORY / "tests" / "proof"
SOURCES = REPOSITORY / "fmu_src"
SHELL = SOURCES / "shell"
DRIVERS = REPOSITORY / "tests" / "drivers"
LENGTH_CHECK = """    if (size != block_size()) {
        return "is truncated or too long";
    }
"""
NOTE = "instance->parameters_unchecked = 1;"

# The struct of a model, the header that declares it, its own sources, and what replaces the rest.
MODELS = {
    "StiffnessEstimator": (
        "sh_estimator_fmu",
        "estimator_fmu.h",
        [SOURCES / name for name in ("StiffnessEstimator.c", "estimator_fmu.c")],
        [PROOF / "shell_library.c"],
    ),
    "AwasPlant": (
        "sh_plant",
        "plant.h",
        [SOURCES / name for name in ("plant.c", "radau.c", "noise.c")],
        [PROOF / "shell_equations.c", PROOF / "library" / "mathematics.c"],
    ),
}
# Functions after which Eva keeps failure and success apart.
OUTCOMES = """
sh_allocate malloc check_parameters is_state defect_of_bytes is_sound defect_of_block
sh_deserialize_state sh_restore_state sh_enter sh_has is_initialized sh_initialize any_choice
importer_allocates sh_end_initialization sh_create sh_set_up sh_begin_initialization
"""
OUTCOMES_OF_AN_ESTIMATOR = """
sh_estimator_fmu_check check sh_parameters_check sh_estimator_check sh_estimator_fmu_is_state
"""
OUTCOMES_OF_A_VERSION = {
    "fmi2": "begin sh_begin_set sh_set find fmi2SetInteger fmi2Instantiate",
    "fmi3": "begin sh_begin_set sh_set find fmi3SetInt32 fmi3SetInt64"
    " fmi3InstantiateCoSimulation fmi3EnterInitializationMode",
}
# Frama-C accepts no conversion to a function with other parameters. The pointer is only kept here,
# as sh_report, which uses it, is replaced.
LOGGER = re.compile(
    r"\((?:fmi2CallbackLogger|fmi3LogMessageCallback)\)instance->importer\.logger"
    r"|\(void \(\*\)\(void\)\)[\w>-]+"
)
# How many states Eva keeps apart in a function; with 0 it joins all that can happen.
APART = ["sh_checksum:0", "sh_accepts:0", "sh_communication_step:100", "set_start_values:0"]
APART_IN_AN_ESTIMATOR = ["sh_estimator_fmu_step:10"]
APART_IN_A_PLANT = [
    *("sh_radau_integrate:0", "take:0", "sh_noise_normal:0", "step:30", "fmin:10", "fmax:10")
]

# States of an instance when a call begins.
APART_BY = [f"//@ dynamic_split instance.{member};" for member in ("parameters_unchecked", "state")]

slow = pytest.mark.slow("the analysis of a shell")


def alarms_of(
    build: Path,
    program: str,
    fmu: str = "StiffnessEstimator",
    *,
    shell: Path = SHELL,
    version: Sequence[Path] = (),
    outcomes: str = "",
    macros: Mapping[str, object] | None = None,
) -> tuple[str, ...]:
    """The alarms of Eva for a program `shell_*.c`, and what it could not prove.

    shell     folder with the sources of the shell
    version   sources of a version of FMI, for a program that calls its functions
    outcomes  more functions after which failure and success are kept apart
    macros    for the preprocessor
    """
    struct, header, own, replacements = MODELS[fmu]
    estimator = fmu == "StiffnessEstimator"
    outcomes = f"{OUTCOMES} {OUTCOMES_OF_AN_ESTIMATOR if estimator else ''} {outcomes}"
    apart = APART + (APART_IN_AN_ESTIMATOR if estimator else APART_IN_A_PLANT)
    found = analyse(
        [
            *(PROOF / program, *replacements),
            *(*sorted(shell.glob("*.c")), *version, *own, library_source("string.c")),
        ],
        "main",
        [
            *(REPOSITORY / "c" / "include", SOURCES, SOURCES / "fmi3", shell),
            *(build / "fmu" / fmu, PROOF, HEADERS, DRIVERS, *{each.parent for each in version}),
        ],
        *("-eva-alloc-builtin", "fresh", "-eva-use-spec", "sh_report"),
        *("-eva-interprocedural-splits", "-eva-slevel", "40"),
        *("-eva-slevel-function", ",".join(apart)),
        *("-eva-auto-loop-unroll", "0" if estimator else "8"),
        *("-eva-split-return-function", ",".join(f"{name}:0" for name in outcomes.split())),
        before=header,
        macros={"MODEL": struct, **(macros or {})},
    )
    assert found.proven >= 1  # the end of the program is reached
    return found.alarms


def alarms_of_calls(
    build: Path, version: str, folder: Path, *, shell: Path = SHELL
) -> tuple[str, ...]:
    """Proof of every call in a version of FMI, whose sources keep no logger of the importer."""
    copies = []
    for source in sorted((SOURCES / version).glob("*.c")):
        copies.append(folder / source.name)
        copies[-1].write_text(LOGGER.sub("NULL", source.read_text()))
    write_calls(version, folder / "calls.h", APART_BY)
    outcomes, macros = OUTCOMES_OF_A_VERSION[version], {"SH_FMI": version[-1]}
    return alarms_of(
        build, "shell_calls.c", shell=shell, version=copies, outcomes=outcomes, macros=macros
    )


@slow
def test_any_bytes_as_the_state_of_an_estimator_are_harmless(build: Path) -> None:
    assert alarms_of(build, "shell_states.c") == ()


@pytest.mark.complete
@slow
def test_the_proof_finds_a_length_that_is_not_checked(build: Path, tmp_path: Path) -> None:
    """GIVEN a shell that compares no length, THEN the proof finds reads beyond the bytes."""
    shell = with_fault(SHELL, tmp_path / "shell", "saved_state.c", LENGTH_CHECK)
    alarms = alarms_of(build, "shell_states.c", shell=shell)
    assert any("saved_bytes.h" in a and "out of bounds read" in a for a in alarms)
    assert any("saved_state.c" in a and "valid_src" in a for a in alarms)


@pytest.mark.complete
@slow
def test_any_bytes_as_the_state_of_a_plant_touch_no_other_memory(build: Path) -> None:
    alarms = alarms_of(build, "shell_states.c", "AwasPlant")
    # Arithmetic that Eva cannot follow: docs/proof/shell.md has the argument for each.
    assert len(alarms) <= 4
    for alarm in alarms:
        assert alarm.startswith(("radau.c", "plant.c")), alarm
        assert "out of bounds" not in alarm and "initialized" not in alarm


@pytest.mark.complete
@slow
@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
def test_any_calls_in_any_order_are_harmless(build: Path, version: str, tmp_path: Path) -> None:
    assert alarms_of_calls(build, version, tmp_path) == ()


@pytest.mark.complete
@slow
def test_the_proof_of_the_calls_finds_a_parameter_that_is_not_noted(
    build: Path, tmp_path: Path
) -> None:
    """GIVEN a shell that does not note a changed parameter, THEN it can reach a tick unchecked."""
    shell = with_fault(SHELL, tmp_path / "shell", "access.c", NOTE)
    alarms = alarms_of_calls(build, "fmi2", tmp_path, shell=shell)
    assert any("assertion 'checked' got status" in alarm for alarm in alarms)
