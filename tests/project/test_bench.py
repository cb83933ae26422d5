"""All programs that the bench compares work and compute the same. No time is measured here."""

import subprocess
import sys
from pathlib import Path

import pytest

from controllers import run
from gate import missing, need

BENCH = Path(__file__).parents[2] / "bench"


@pytest.mark.slow("the programs of the bench are compiled")
def test_all_subjects_work_and_compute_the_same(build: Path, tmp_path: Path) -> None:
    need("c++")
    if not sys.platform.startswith("linux"):
        pytest.skip("the bench is for Linux")
    configured = subprocess.run(
        [
            *("cmake", "-S", str(BENCH), "-B", str(tmp_path), "-G", "Ninja"),
            "-DCMAKE_BUILD_TYPE=Release",
            f"-DCMAKE_MAKE_PROGRAM={build / 'venv' / 'bin' / 'ninja'}",
        ],
        capture_output=True,
        text=True,
    )
    if "apt-get install" in configured.stderr:
        missing("Eigen", "apt-get install libeigen3-dev")
    assert configured.returncode == 0, configured.stderr
    run("cmake", "--build", tmp_path)
    assert "subjects work" in run(sys.executable, BENCH / "run.py", "--build", tmp_path, "--check")
