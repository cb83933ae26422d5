"""No run-time error is possible in c/: shown by Frama-C Eva for all inputs.

A tick is analysed with contracts in place of the functions that work on triangles (contracts.h), in
a loop that is analysed to its fixpoint: so the result holds for any number of ticks. The functions
themselves are analysed for each number of columns with all loops unrolled.

What takes minutes is left to the preset `proof`, which runs all sizes: SIGMAHAT_PROOF is set there.
"""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

import c_sources
from eva import Analysis, analyse

HERE = Path(__file__).parent / "library"
ALL_SIZES = bool(os.environ.get("SIGMAHAT_PROOF"))
MAX_COLUMNS, MAX_PARAMETERS = 64, 40
WITHOUT_CURVE = 10
"""Largest number of columns where prior.tau_e is 0: the nominal curve, and nine others."""

TRIANGLES = (
    *("sh_information_take", "sh_information_start", "sh_information_copy"),
    *("sh_information_sample", "sh_information_side", "sh_information_last"),
    *("sh_information_solve", "sh_information_project", "sh_information_squares"),
    *("sh_information_walk", "sh_ud_factor_start", "sh_ud_factor_project"),
    *("sh_ud_factor_update", "sh_ud_factor_variance"),
)
"""Functions that contracts.h stands for."""

# A path of the check that refuses a state must stay apart from the one that accepts it.
APART = (
    *("-eva-split-return", "full", "-eva-slevel-function"),
    "restored:9999,sh_estimator_check:9999,sh_matched_filter_check_state:9999,are_columns:99,"
    "are_data:30,is_choice:1000,knows_motor:4,is_pass:30,are_flags:30",
)


def library(
    program: str, main: str, *options: str, of: Path = c_sources.LIBRARY, **macros: object
) -> Analysis:
    """Analyses the library in the folder `of` from `main` in the file `program` on."""
    return analyse(
        [HERE / f"{program}.c", HERE / "mathematics.c", *sorted(of.rglob("*.c"))],
        main,
        [*sorted({header.parent for header in of.rglob("*.h")}), HERE],
        *options,
        **{"PROOF_METHOD": 2, "PROOF_SIZE": 1, "PROOF_CURVE": 1, "SH_REAL": "double", **macros},
    )


def ticks(main: str, real: str, method: int, size: int, curve: bool) -> Analysis:
    replaced = [*TRIANGLES, "sh_columns_count", *([] if curve else ["sh_has_nominal_curve"])]
    return library(
        *("ticks", main, "-eva-use-spec", ",".join(replaced), *APART),
        PROOF_METHOD=method,
        PROOF_SIZE=size,
        PROOF_CURVE=int(curve),
        SH_REAL=real,
    )


def assert_proven(analysis: Analysis, least_coverage: int) -> None:
    assert analysis.alarms == ()
    # What is not reached is not proven either: an analysis that ends early finds nothing.
    assert analysis.coverage >= least_coverage and analysis.proven >= 1, analysis.text


BOTH = ("started", "restored")
REALS = ("double", "float")


@pytest.mark.parametrize(
    ("main", "real"),
    [(main, real) for main in BOTH for real in REALS] if ALL_SIZES else [("restored", "double")],
)
def test_paper2011(main: str, real: str) -> None:
    assert_proven(ticks(main, real, method=1, size=1, curve=True), 97)


@pytest.mark.slow("the analysis of a tick by MatchedFilter")
@pytest.mark.parametrize(
    ("main", "real", "size", "curve"),
    [
        (main, real, size, curve)
        for main in BOTH
        for real in REALS
        for curve, most in ((True, MAX_COLUMNS), (False, WITHOUT_CURVE))
        for size in range(1, most + 1)
    ]
    if ALL_SIZES
    else [("started", "double", MAX_COLUMNS, True), ("restored", "float", 5, False)],
)
def test_matched_filter(main: str, real: str, size: int, curve: bool) -> None:
    assert_proven(ticks(main, real, method=2, size=size, curve=curve), 98)


@pytest.mark.parametrize("real", REALS if ALL_SIZES else ["double"])
@pytest.mark.parametrize(
    ("first", "last"),
    [(size, size) for size in range(1, MAX_COLUMNS + 1)] if ALL_SIZES else [(1, 6)],
)
def test_information(first: int, last: int, real: str) -> None:
    assert_proven(sizes("information", first, last, real), 80 if first < 5 else 99)


@pytest.mark.parametrize("real", REALS if ALL_SIZES else ["float"])
@pytest.mark.parametrize(
    ("first", "last"),
    [(size, size) for size in range(1, MAX_PARAMETERS + 1)] if ALL_SIZES else [(1, 6)],
)
def test_ud_factor(first: int, last: int, real: str) -> None:
    assert_proven(sizes("ud_factor", first, last, real), 60 if first < 9 else 90)


def sizes(program: str, first: int, last: int, real: str, of: Path = c_sources.LIBRARY) -> Analysis:
    return library(
        *(program, "sizes", "-eva-min-loop-unroll", str(MAX_COLUMNS + 6)),
        of=of,
        PROOF_FIRST=first,
        PROOF_LAST=last,
        SH_REAL=real,
    )


@pytest.mark.parametrize("real", REALS if ALL_SIZES else ["float"])
def test_information_stays_positive(real: str) -> None:
    assert_proven(library("information", "positive", SH_REAL=real), 50)


def test_parameters_that_pass_are_those_of_the_proof() -> None:
    assert_proven(library("check", "refused", "-eva-min-loop-unroll", "60"), 80)


@pytest.mark.parametrize("method", [1, 2] if ALL_SIZES else [2])
def test_check_of_parameters(method: int) -> None:
    assert_proven(library("check", "in_range", PROOF_METHOD=method), 90)


def test_an_index_one_too_far_is_found(tmp_path: Path) -> None:
    of = with_fault(
        *(tmp_path, "ud_factor.c", "for (; j < size; ++j) {\n            const sh_pair s_j"),
        "for (; j <= size; ++j) {\n            const sh_pair s_j",
    )
    alarms = sizes("ud_factor", MAX_PARAMETERS, MAX_PARAMETERS, "double", of).alarms
    assert any(alarm.startswith("ud_factor.c:") for alarm in alarms), alarms


def test_information_that_is_not_checked_is_found(tmp_path: Path) -> None:
    of = with_fault(
        *(tmp_path, "matched_filter/information.c", "if (sh_fabs(xi) > 0 && after > 0) {"),
        "if (sh_fabs(xi) > 0) {",
    )
    (alarm,) = library("information", "positive", of=of).alarms
    assert alarm.startswith("information.c:") and "positive" in alarm


def with_fault(folder: Path, file: str, code: str, fault: str) -> Path:
    """A copy of the library in which `fault` stands in place of `code`."""
    copy = folder / "c"
    shutil.copytree(c_sources.LIBRARY, copy)
    text = (copy / file).read_text()
    assert text.count(code) == 1
    (copy / file).write_text(text.replace(code, fault))
    return copy
