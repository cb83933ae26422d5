"""No run-time error is possible in c/: shown by Frama-C Eva for all inputs.

Contracts (contracts.h) replace the functions that work on triangles. A tick is analysed in a loop
to its fixpoint, so the result holds for any number of ticks. The functions
themselves are analysed for each number of columns, in arrays that are just large enough.

The preset `complete` runs all of it; the tests of the gate run some.
"""

import os
import re
import shutil
from pathlib import Path

import pytest

import c_sources
from eva import Analysis, analyse, with_fault

HERE = Path(__file__).parent / "library"
ALL = bool(os.environ.get("SIGMAHAT_COMPLETE"))
MAX_COLUMNS, MAX_PARAMETERS = 64, 40
BOTH = ("started", "restored")
REALS = ("double", "float")
MACROS = {"PROOF_METHOD": 2, "PROOF_CURVE": 1, "SH_REAL": "double"}
UNROLLED = ("-eva-min-loop-unroll", str(MAX_COLUMNS + 6))

TRIANGLES = re.findall(
    r"^\w.*\b(sh_(?:information|least_squares)_\w+)\(", (HERE / "contracts.h").read_text(), re.M
)
"""Functions that contracts.h stands for."""

# Eva must keep the paths apart in which the check rejects and accepts a state.
APART = (
    *("-eva-split-return", "full", "-eva-slevel-function"),
    "restored:9999,sh_estimator_check:9999,sh_filtered_regression_check_state:9999,are_columns:99,"
    "is_choice:1000,are_numbers:200",
)


def library(program: str, main: str, *options: str, **macros: object) -> Analysis:
    """Analyses the whole library from `main` in the file `program` on."""
    return analyse(
        [HERE / f"{program}.c", HERE / "mathematics.c", *c_sources.SOURCES],
        main,
        [*c_sources.FOLDERS, HERE],
        *options,
        macros={**MACROS, **macros},
    )


def ticks(main: str, real: str, method: int, curve: bool) -> Analysis:
    replaced = [*TRIANGLES, "sh_columns_count", *([] if curve else ["sh_has_nominal_curve"])]
    options = ("-eva-use-spec", ",".join(replaced), *APART)
    macros = {"PROOF_METHOD": method, "PROOF_CURVE": int(curve), "SH_REAL": real}
    return library("ticks", main, *options, **macros)


def part(
    name: str, main: str, real: str, folder: Path, of: Path = c_sources.LIBRARY, **sizes: int
) -> Analysis:
    """Analyses one file, from `main` of its program here on, in an estimator of these sizes."""
    (source,) = of.rglob(f"{name}.c")
    sources = [HERE / f"{name}.c", HERE / "mathematics.c", source]
    folders = [with_guards(folder), of, of / "filtered_regression", HERE]
    macros = {**MACROS, "SH_REAL": real, **sizes}
    return analyse(sources, main, folders, *UNROLLED, macros=macros)


def with_guards(folder: Path) -> Path:
    """A copy of c/include in which every array of a struct is followed by one that nobody may use.

    To Eva, an index behind the end of an array is no error if another member of the struct follows.
    """
    copy = folder / "include"
    shutil.copytree(c_sources.LIBRARY / "include", copy)
    header = copy / "sigmahat_state.h"
    text, count = re.subn(
        r"^( +)(sh_real|sh_ud_column|int|short) (\w+\[[^;]*\]);",
        lambda line: " ".join(
            f"{line[1]}{line[2]} {array}; {line[2]} guard_{array.split('[')[0]}[8];"
            for array in line[3].split(", ")
        ),
        header.read_text(),
        flags=re.MULTILINE,
    )
    assert count > 10
    header.write_text(text)
    return copy


def assert_proven(analysis: Analysis, least_coverage: int) -> None:
    assert analysis.alarms == ()
    # Code that is not reached is not proven: an analysis that ends early finds nothing.
    assert analysis.coverage >= least_coverage and analysis.proven >= 1, analysis.text


@pytest.mark.parametrize(
    ("main", "real"),
    [(main, real) for main in BOTH for real in REALS] if ALL else [("restored", "double")],
)
def test_paper2011(main: str, real: str) -> None:
    assert_proven(ticks(main, real, method=1, curve=True), 97)


@pytest.mark.slow("the analysis of a tick by FilteredRegression")
@pytest.mark.parametrize(
    ("main", "real", "curve"),
    [(main, real, curve) for main in BOTH for real in REALS for curve in (True, False)]
    if ALL
    else [("restored", "float", False)],
)
def test_filtered_regression(main: str, real: str, curve: bool) -> None:
    assert_proven(ticks(main, real, method=2, curve=curve), 98)


@pytest.mark.parametrize("real", REALS if ALL else ["double"])
@pytest.mark.parametrize("columns", range(1, MAX_COLUMNS + 1) if ALL else [7])
def test_information(columns: int, real: str, tmp_path: Path) -> None:
    found = part("information", "columns", real, tmp_path, SH_MAX_COLUMNS=columns)
    assert_proven(found, 80 if columns < 6 else 99)


def test_rows_of_information(tmp_path: Path) -> None:
    most = MAX_COLUMNS if ALL else 9
    assert_proven(part("information", "rows", "double", tmp_path, SH_MAX_COLUMNS=most), 99)


@pytest.mark.parametrize("real", REALS if ALL else ["float"])
@pytest.mark.parametrize("parameters", range(1, MAX_PARAMETERS + 1) if ALL else [17])
def test_least_squares(parameters: int, real: str, tmp_path: Path) -> None:
    found = part("least_squares", "parameters", real, tmp_path, SH_MAX_N=parameters, SH_MAX_M=1)
    # Only an odd number of parameters has a last column that is alone.
    assert_proven(found, 90 if parameters % 2 == 1 and parameters > 1 else 60)


@pytest.mark.parametrize("real", REALS if ALL else ["float"])
def test_information_stays_positive(real: str, tmp_path: Path) -> None:
    assert_proven(part("information", "positive", real, tmp_path, SH_MAX_COLUMNS=1), 50)


def test_parameters_that_pass_are_those_of_the_proof() -> None:
    assert_proven(library("check", "refused", "-eva-min-loop-unroll", "60"), 80)


@pytest.mark.parametrize("method", [1, 2] if ALL else [2])
def test_check_of_parameters(method: int) -> None:
    assert_proven(library("check", "in_range", PROOF_METHOD=method), 90)


def test_an_index_one_too_far_is_found(tmp_path: Path) -> None:
    """GIVEN a loop that takes a column too many."""
    code = "if (j < size) {\n        const rotation"
    fault = code.replace("<", "<=")
    of = with_fault(c_sources.LIBRARY, tmp_path / "c", "least_squares.c", code, fault)
    found = part("least_squares", "parameters", "double", tmp_path, of, SH_MAX_N=6, SH_MAX_M=1)
    (alarm,) = found.alarms
    assert alarm.startswith("least_squares.c:") and "out of bounds" in alarm


def test_information_that_is_not_checked_is_found(tmp_path: Path) -> None:
    file, check = "filtered_regression/information.c", " && after > SH_SMALLEST_D))"
    of = with_fault(c_sources.LIBRARY, tmp_path / "c", file, check, "))")
    (alarm,) = part("information", "positive", "double", tmp_path, of, SH_MAX_COLUMNS=1).alarms
    assert alarm.startswith("information.c:") and "positive" in alarm
