"""All programs that the benchmark compares compute the same results; no time is measured."""

import sys
from pathlib import Path

import pytest

from c_sources import REPOSITORY
from controllers import HOST, cross_build, run
from gate import missing, need


@pytest.mark.slow("the programs of the bench are compiled")
def test_all_subjects_work_and_compute_the_same(tmp_path: Path) -> None:
    need("c++")
    if not sys.platform.startswith("linux"):
        pytest.skip("the bench is for Linux")
    try:
        tree = cross_build("bench", HOST, "double", tmp_path)
    except AssertionError as error:
        if "apt-get install" in str(error):
            missing("Eigen", "apt-get install libeigen3-dev")
        raise
    program = REPOSITORY / "bench" / "run.py"
    assert "subjects work" in run(sys.executable, program, "--build", tree, "--check")
