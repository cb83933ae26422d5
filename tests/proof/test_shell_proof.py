"""The shell of the FMUs, proven by Frama-C Eva: saved states, value references, instances.

The programs `shell_*.c` call the shell as an importer may; docs/proof/shell.md says what they
cover.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import fmpy
import pytest

from eva import analyse, library_source

REPOSITORY = Path(__file__).resolve().parents[2]
PROOF = REPOSITORY / "tests" / "proof"
SOURCES = REPOSITORY / "fmu_src"
SHELL = SOURCES / "shell"
FMI_HEADERS = Path(fmpy.__file__).parent / "c-code"
LENGTH_CHECK = " || size != sh_block_size()"

# The struct of a model, the header that declares it, its own sources, and what replaces the rest.
MODELS = {
    "StiffnessEstimator": (
        "sh_estimator_fmu",
        "estimator_fmu.h",
        ["StiffnessEstimator.c", "estimator_fmu.c", "sample_clock.c"],
        "shell_library.c",
    ),
    "AwasPlant": ("sh_plant", "plant.h", ["plant.c", "radau.c", "noise.c"], "shell_equations.c"),
}
# Functions after which Eva keeps failure and success apart.
OUTCOMES = [
    *("sh_allocate", "malloc", "sh_check_parameters", "sh_check_ranges", "is_state"),
    *("sh_block_is_sound", "sh_block_defect", "sh_deserialize_state", "sh_restore_state"),
    *("sh_enter", "sh_has", "has_course", "is_initialized", "sh_initialize", "any_choice"),
    *("importer_allocates", "sh_end_initialization", "sh_create"),
]
OUTCOMES_OF_AN_ESTIMATOR = [
    *("sh_estimator_fmu_check", "check", "sh_parameters_check", "sh_estimator_check"),
    *("sh_estimator_fmu_is_state", "sh_sample_clock_is_state", "sh_sample_clock_tick"),
]
OUTCOMES_OF_ACCESS = ["sh_enter", "sh_has", "begin", "sh_begin_set", "find"]
# How many states Eva keeps apart in a function; with 0 it joins all that can happen.
APART = [
    *("sh_check_ranges:0", "checksum:0", "sh_accepts:0", "sh_communication_step:100"),
    "sh_reset:0",
]
APART_IN_AN_ESTIMATOR = ["sh_estimator_fmu_step:10"]
APART_IN_A_PLANT = [
    *("sh_radau_integrate:0", "take:0", "sh_noise_normal:0", "step:30", "fmin:10", "fmax:10")
]

by_hand = pytest.mark.skipif(
    not os.environ.get("SIGMAHAT_PROOF"), reason="runs with SIGMAHAT_PROOF=1 in the environment"
)


def alarms_of(
    build: Path,
    program: str,
    fmu: str,
    options: list[str],
    *,
    shell: Path = SHELL,
    version: str | None = None,
    main: str = "main",
) -> tuple[str, ...]:
    """The alarms of Eva for a program `shell_*.c`, and what it could not prove.

    shell    folder with the sources of the shell
    version  of FMI, for a program that calls its functions for variables
    """
    struct, header, own, replacement = MODELS[fmu]
    found = analyse(
        [
            *(PROOF / name for name in (program, "shell_importer.c", replacement)),
            *sorted(shell.glob("*.c")),
            *([] if version is None else [SOURCES / version / "variables.c"]),
            *(SOURCES / name for name in own),
            library_source("string.c"),
        ],
        main,
        [REPOSITORY / "c" / "include", SOURCES, SHELL, build / "fmu" / fmu, PROOF, FMI_HEADERS],
        *("-eva-alloc-builtin", "fresh", "-eva-use-spec", "sh_log", *options),
        before=header,
        macros={"MODEL": struct},
    )
    return found.alarms


def analyse_course(
    build: Path,
    fmu: str,
    program: str = "shell_states.c",
    shell: Path = SHELL,
    main: str = "main",
) -> tuple[str, ...]:
    """The alarms of a program that goes through states, initialisation and steps."""
    estimator = fmu == "StiffnessEstimator"
    outcomes = OUTCOMES + (OUTCOMES_OF_AN_ESTIMATOR if estimator else [])
    apart = APART + (APART_IN_AN_ESTIMATOR if estimator else APART_IN_A_PLANT)
    options = [
        *("-eva-slevel", "40", "-eva-slevel-function", ",".join(apart)),
        *("-eva-auto-loop-unroll", "0" if estimator else "8"),
        *("-eva-split-return-function", ",".join(f"{name}:0" for name in outcomes)),
    ]
    return alarms_of(build, program, fmu, options, shell=shell, main=main)


@pytest.mark.slow("the analysis of an estimator's shell")
def test_any_bytes_as_the_state_of_an_estimator_are_harmless(build: Path) -> None:
    assert analyse_course(build, "StiffnessEstimator") == ()


@pytest.mark.slow("the analysis of an estimator's shell")
def test_the_proof_finds_a_length_that_is_not_checked(build: Path, tmp_path: Path) -> None:
    """GIVEN a shell that compares no length, THEN the proof finds reads beyond the bytes."""
    shell = tmp_path / "shell"
    shutil.copytree(SHELL, shell)
    file = shell / "state_block.c"
    text = file.read_text()
    assert LENGTH_CHECK in text
    file.write_text(text.replace(LENGTH_CHECK, ""))
    alarms = analyse_course(build, "StiffnessEstimator", shell=shell)
    assert any("state_block.c" in a and "out of bounds read" in a for a in alarms)
    assert any("saved_state.c" in a and "valid_src" in a for a in alarms)


@pytest.mark.slow("the analysis of a plant's shell")
def test_any_bytes_as_the_state_of_a_plant_touch_no_other_memory(build: Path) -> None:
    alarms = analyse_course(build, "AwasPlant")
    # Arithmetic that Eva cannot follow: docs/proof/shell.md has the argument for each.
    assert len(alarms) <= 4
    for alarm in alarms:
        assert alarm.startswith(("radau.c", "plant.c")), alarm
        assert "out of bounds" not in alarm and "initialized" not in alarm


@by_hand
@pytest.mark.parametrize("version", ["fmi2", "fmi3"])
def test_any_value_reference_is_harmless(build: Path, version: str) -> None:
    options = [
        *("-eva-slevel", "12", "-eva-slevel-function", "main:50"),
        *("-eva-split-return-function", ",".join(f"{n}:0" for n in OUTCOMES_OF_ACCESS)),
    ]
    program = f"shell_access_{version}.c"
    alarms = alarms_of(build, program, "StiffnessEstimator", options, version=version)
    # NaN as an integer: only a Float64 can be NaN, and no Float64 is written to an integer.
    expected = ["value.c"] if version == "fmi3" else []
    assert [alarm.split(":")[0] for alarm in alarms] == expected


@by_hand
def test_every_call_in_every_state_is_harmless(build: Path) -> None:
    assert analyse_course(build, "StiffnessEstimator", main="calls") == ()


@by_hand
def test_the_life_of_an_instance_uses_no_freed_memory(build: Path) -> None:
    alarms = analyse_course(build, "StiffnessEstimator", "shell_course.c")
    # `after` is written where the clock returns 1; Eva joins both outcomes after many ticks.
    assert [alarm.split(":")[0] for alarm in alarms] == ["estimator_fmu.c"]
    assert "initialized(&after)" in alarms[0]
