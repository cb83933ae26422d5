"""Mutation testing: the tests of the library notice a wrong token in its code."""

import subprocess
import sys

import pytest

from c_sources import REPOSITORY
from gate import need
from mutation import EQUIVALENT, SOURCES, candidates


@pytest.mark.parametrize(("file", "code"), [(file, code) for file, code, _ in EQUIVALENT])
def test_every_exemption_is_of_code_that_exists(file: str, code: str) -> None:
    mutants = (mutant for choices in candidates(SOURCES[file], "") for mutant in choices)
    assert any(mutant.makes(code) for mutant in mutants)


@pytest.mark.skipif(sys.platform != "linux", reason="the time of a mutant is limited by Linux")
@pytest.mark.complete
@pytest.mark.slow("six mutants of the library are compiled and tested")
def test_nearly_every_wrong_token_is_noticed() -> None:
    need("gcc")
    command = [sys.executable, str(REPOSITORY / "tests" / "studies" / "mutation.py")]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
