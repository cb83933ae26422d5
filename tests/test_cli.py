"""The command line, as a user meets it."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import time
from importlib.metadata import version
from pathlib import Path

import pytest

import sigmahat
from sigmahat.cli import main
from sigmahat.scenarios import SCENARIOS

COMMAND = [sys.executable, "-m", "sigmahat"]


def run(*arguments: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run([*COMMAND, *arguments], cwd=cwd, capture_output=True, text=True)


def refused(*arguments: str, cwd: Path) -> str:
    """Runs a command that must fail with one line, and returns that line."""
    done = run(*arguments, cwd=cwd)
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith("sigmahat: error: ")
    return line


def test_reproduce_prints_the_table_and_writes_every_file(tmp_path: Path) -> None:
    done = run("reproduce", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    out = tmp_path / "sigmahat-results" / "table1"
    assert str(out) in done.stdout
    for words in ("table1", "V_a", "MODEL", "24.14", "SENSOR", "24.36", "RESIDUAL", "128.16"):
        assert words in done.stdout
    expected = {f"{name}.{kind}" for name in SCENARIOS["table1"].figures for kind in ("png", "svg")}
    expected |= {"MODEL.csv", "MODEL-measured.csv", "SENSOR.csv", "RESIDUAL.csv", "table.csv"}
    assert {path.name for path in out.iterdir()} == expected


def test_another_scenario_has_its_own_files(tmp_path: Path) -> None:
    done = run("reproduce", "--scenario", "single-hardening", "--out", "here", cwd=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert {path.name for path in (tmp_path / "here").iterdir()} == {
        "summary.png",
        "summary.svg",
        "RESIDUAL.csv",
        "RESIDUAL-paper-prior.csv",
        "table.csv",
    }


def test_scenario_seeds_and_folder_are_taken(tmp_path: Path) -> None:
    done = run(
        "reproduce", "--scenario", "as-printed", "--seeds", "2", "--out", "here", cwd=tmp_path
    )
    assert done.returncode == 0
    assert "as-printed" in done.stdout
    assert "2 seeds" in done.stdout
    assert " +- " in done.stdout
    assert [path.name for path in tmp_path.iterdir()] == ["here"]


def test_scenarios_are_listed_one_a_line(tmp_path: Path) -> None:
    done = run("scenarios", cwd=tmp_path)
    lines = done.stdout.splitlines()
    assert [line.split()[0] for line in lines] == list(SCENARIOS)
    for line, scenario in zip(lines, SCENARIOS.values(), strict=True):
        assert line.endswith(scenario.description)


def test_version(tmp_path: Path) -> None:
    assert run("--version", cwd=tmp_path).stdout == f"sigmahat {version('sigmahat')}\n"


def test_help_names_every_command_and_option(tmp_path: Path) -> None:
    help_ = run("--help", cwd=tmp_path).stdout
    assert "reproduce" in help_
    assert "scenarios" in help_
    help_ = run("reproduce", "--help", cwd=tmp_path).stdout
    for option in ("--scenario", "--seeds", "--out"):
        assert option in help_


def test_the_shell_completes_commands_and_options(tmp_path: Path) -> None:
    for words, expected in (
        ("sigmahat rep", "report reproduce"),
        ("sigmahat sweep --sc", "--scenario --scheduler"),
    ):
        asked = {"_SIGMAHAT_COMPLETE": "bash_complete", "COMP_WORDS": words}
        asked["COMP_CWORD"] = str(len(words.split()) - 1)
        done = subprocess.run(
            COMMAND, cwd=tmp_path, env={**os.environ, **asked}, capture_output=True, text=True
        )
        found = [line.removeprefix("plain,") for line in done.stdout.splitlines()]
        assert sorted(found) == sorted(expected.split())


def test_help_imports_nothing_slow() -> None:
    code = (
        "import sys, sigmahat.cli; sigmahat.cli.main(['--help'])\n"
        "slow = {'numpy', 'fmpy', 'matplotlib', 'casadi', 'scipy', 'pyarrow', 'bokeh', 'dask'}\n"
        "print(sorted(slow & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "[]"


def test_unknown_scenario(tmp_path: Path) -> None:
    line = refused("reproduce", "--scenario", "tabel1", cwd=tmp_path)
    assert "did you mean 'table1'?" in line
    assert all(name in line for name in SCENARIOS)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("seeds", ["0", "-3", "two", "1.5"])
def test_bad_number_of_seeds(seeds: str, tmp_path: Path) -> None:
    assert "--seeds" in refused("reproduce", "--seeds", seeds, cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("arguments", [["reprodce"], ["reproduce", "--sedes", "2"]])
def test_unknown_command_and_option(arguments: list[str], tmp_path: Path) -> None:
    line = refused(*arguments, cwd=tmp_path)
    assert "reproduce" in line or "--seeds" in line


@pytest.mark.parametrize("out", ["file", "file/below"])
def test_folder_that_is_a_file(out: str, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    started = time.monotonic()
    line = refused("reproduce", "--seeds", "500", "--out", out, cwd=tmp_path)
    assert "file is a file" in line or "choose another folder with --out" in line
    assert time.monotonic() - started < 30  # refused before anything is computed
    assert (tmp_path / "file").read_text() == "mine"


def test_folder_without_a_name(tmp_path: Path) -> None:
    assert "empty name" in refused("reproduce", "--out", "", cwd=tmp_path)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_output_that_cannot_be_written(tmp_path: Path) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [*COMMAND, "scenarios"], cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True
        )
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "cannot write the output" in line


@pytest.mark.skipif(not Path("/proc/self").exists(), reason="no folder that nobody may write to")
def test_folder_that_cannot_be_made(tmp_path: Path) -> None:
    line = refused("reproduce", "--out", "/proc/sigmahat", cwd=tmp_path)
    assert "cannot write /proc/sigmahat" in line


def test_folder_without_permission(tmp_path: Path) -> None:
    locked = tmp_path / "locked"
    locked.mkdir(mode=0o500)
    if os.access(locked, os.W_OK):
        pytest.skip("this user may write everywhere")
    assert "locked" in refused("reproduce", "--out", "locked/results", cwd=tmp_path)
    assert list(locked.iterdir()) == []


@pytest.mark.parametrize("compiler", [None, "/usr/bin/cc"])
def test_fmus_not_built(
    compiler: str | None,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    def missing(name: str) -> Path:
        raise FileNotFoundError(name)

    monkeypatch.setattr(sigmahat, "fmu", missing)
    monkeypatch.setattr(shutil, "which", lambda name: compiler)
    assert main(["reproduce", "--out", str(tmp_path / "out")]) == 2
    (line,) = capsys.readouterr().err.splitlines()
    assert "cmake --workflow --preset build" in line
    assert ("install a C compiler" in line) == (compiler is None)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("seeds", "delay"), [("1", 0.6), ("100", 0.5), ("100", 0.7), ("100", 1.5), ("100", 4.0)]
)
def test_interrupt(seeds: str, delay: float, tmp_path: Path) -> None:
    """Ctrl-C reaches the whole process group, at any time."""
    process = subprocess.Popen(
        [*COMMAND, "reproduce", "--seeds", seeds],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    time.sleep(delay)
    os.killpg(process.pid, signal.SIGINT)
    output, errors = process.communicate(timeout=30)
    # Python ends by the signal itself if that came while it was importing; to a shell it is 130.
    assert process.returncode in (130, -signal.SIGINT)
    assert output == ""
    assert errors.split("\n") == ["", "sigmahat: interrupted", ""]
    assert list(tmp_path.iterdir()) == []
