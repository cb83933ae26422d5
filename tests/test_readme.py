"""What the README shows works as it says."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

README = Path(__file__).parent.parent / "README.md"


def test_the_example_gives_the_stiffness_of_its_joint(estimator_fmu: Path, tmp_path: Path) -> None:
    (program,) = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)
    folder = tmp_path / "build" / "venv" / "share" / "sigmahat"
    folder.mkdir(parents=True)
    (folder / estimator_fmu.name).write_bytes(estimator_fmu.read_bytes())
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    value, unit = done.stdout.split()
    assert unit == "N.m/rad"
    assert f"It prints {float(value):.1f}:" in README.read_text()
    assert abs(float(value) - 1000.0) < 1.0
