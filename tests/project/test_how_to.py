"""The how-to pages: what they show is run, what they link to is there."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import fmpy
import numpy as np
import pytest

import sigmahat
from fmi_master import run, torques
from sigmahat.runs.scenario import T

REPOSITORY = Path(__file__).parents[2]
PAGES = REPOSITORY / "docs" / "how-to"


def blocks(page: str, language: str) -> Iterator[str]:
    """Code blocks of a page in their order."""
    text = (PAGES / page).read_text(encoding="utf-8")
    return (m[1] for m in re.finditer(rf"^```{language}\n(.*?)^```$", text, re.M | re.S))


@pytest.mark.parametrize("page", sorted(PAGES.glob("*.md")), ids=lambda page: page.name)
def test_links_to_files_and_from_the_readme(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)", page.read_text(encoding="utf-8")):
        assert target.startswith("https://") or (page.parent / target).is_file(), target
    assert f"(docs/how-to/{page.name})" in (REPOSITORY / "README.md").read_text(encoding="utf-8")


@pytest.mark.skipif(fmpy.platform != "linux64", reason="the page names the Linux binary")
def test_c_master(tmp_path: Path) -> None:
    """The commands of the page, in a folder of their own."""
    (commands,) = blocks("c-master.md", "sh")
    (tmp_path / "examples").symlink_to(REPOSITORY / "examples")
    done = subprocess.run(
        ["sh", "-e", "-c", commands],
        cwd=tmp_path,
        env={
            # The python3 that runs this test, which has FMPy.
            "PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}",
            "FMU": str(sigmahat.fmu("StiffnessEstimator")),
        },
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    printed = re.fullmatch(r"sigma = (\S+) N\.m/rad\n", done.stdout)
    assert printed and float(printed[1]) == pytest.approx(150.0, rel=1e-3)


@pytest.fixture(scope="module")
def page() -> dict[str, Any]:
    """Names after the code blocks of the FMPy page, run in their order."""
    names: dict[str, Any] = {}
    for code in blocks("fmpy.md", "python"):
        exec(compile(code, "fmpy.md", "exec"), names)
    return names


def test_fmpy_page_gives_the_run_of_a_master_by_hand(page: dict[str, Any]) -> None:
    times = page["t"]
    own = run(torques(times), late=False, linear=False, times=times)
    np.testing.assert_allclose(page["plant"]["sigma"], own["plant.sigma"], rtol=1e-9)
    # The outputs of the tick at t_k are there after the step.
    ticks = own["estimator.sigma"][:-1]
    np.testing.assert_allclose(page["estimate"]["sigma"][1:], ticks, rtol=1e-9)
    assert ticks[-1] > 0


def test_fmpy_page_tunable_acts_from_the_next_tick_on(page: dict[str, Any]) -> None:
    before = page["tuned"]["time"] < 1.5 + T / 2
    same = page["tuned"]["sigma"] == page["estimate"]["sigma"]
    assert same[before].all() and not same[~before].any()
    # The estimate is kept: one tick does not move it far.
    first = np.flatnonzero(~before)[0]
    assert page["tuned"]["sigma"][first] == pytest.approx(
        page["tuned"]["sigma"][first - 1], rel=1e-3
    )


def test_fmpy_page_system_finds_the_stiffness(page: dict[str, Any]) -> None:
    settled = page["system"]["time"] > 1.0
    np.testing.assert_allclose(
        page["system"]["sigma_hat"][settled], page["system"]["sigma"][settled], rtol=0.05
    )
