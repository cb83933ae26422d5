"""Tests of the command line from the view of a user."""

import csv
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from command_line import Shell
from controllers import run
from gate import need
from recorded_logs import CONFIGURATION, awas_log, write_log
from sigmahat.cli import cli
from sigmahat.experiments.records import NAME
from sigmahat.fmi import installed
from sigmahat.paper.scenarios import SCENARIOS

QUICK = "sweep --modality RESIDUAL"
MOTION = "motion --angle 0.8 --velocity 1.5 --torque 60 --deformation 0.03"


@pytest.mark.slow("a whole reproduction with its figures")
def test_reproduce_prints_the_table_and_writes_every_file(shell: Shell) -> None:
    printed, out = shell.run("reproduce"), Path("sigmahat-results", "table1").absolute()
    assert shell.err == ""
    words = ("table1", "V_a", "MODEL", "24.14", "SENSOR", "24.36", "RESIDUAL", "128.16")
    assert all(each in printed for each in (str(out), *words))
    expected = {f"{name}.{kind}" for name in SCENARIOS["table1"].figures for kind in ("png", "svg")}
    expected |= {"MODEL.csv", "MODEL-measured.csv", "SENSOR.csv", "RESIDUAL.csv", "table.csv"}
    assert {path.name for path in out.iterdir()} == expected


def test_scenarios_are_listed_one_a_line(shell: Shell) -> None:
    lines = shell.run("scenarios").splitlines()
    assert [line.split()[0] for line in lines] == list(SCENARIOS)
    for line, scenario in zip(lines, SCENARIOS.values(), strict=True):
        assert line.endswith(scenario.description)


@pytest.mark.parametrize("name", ["", *sorted(cli.commands)])
def test_help_has_an_example_that_parses(name: str, shell: Shell) -> None:
    printed = shell.run(f"{name} --help")
    assert shell.err == ""
    (example,) = re.findall(r"Example: sigmahat ((?:.*\\\n)*.*)\n$", printed)
    first, *arguments = example.replace("\\\n", "").split()
    assert first == name or not name
    with cli.commands[first].make_context(first, arguments):
        pass


@pytest.mark.slow("a whole reproduction with its figures")
def test_json_of_reproduce_is_its_table(shell: Shell) -> None:
    printed = shell.json("reproduce --scenario single-linear")
    assert shell.err == ""
    assert (printed["scenario"], printed["seeds"]) == ("single-linear", [1])
    with Path("sigmahat-results/single-linear/table.csv").open() as file:
        rows = list(csv.DictReader(file))
    for row, line in zip(printed["table"], rows, strict=True):
        about = [row["estimation"], row["seeds"]]
        fields = [row[field] for field in ("mse", "msrep", "msrep_settled")]
        cells = [each[key] for each in fields for key in ("mean", "half_width")]
        paper = [row["paper"][field] for field in ("mse", "msrep")]
        as_text = ["" if v is None else str(v) for v in (*about, *cells, *paper)]
        assert as_text == list(line.values())
    assert set(printed["units"]) >= {"mse", "msrep", "msrep_settled"}


def test_bash_completes(tmp_path: Path) -> None:
    """GIVEN the line of .bashrc that the documentation recommends, THEN bash completes commands."""
    bash = need("bash")
    page = (Path(__file__).parents[2] / "docs" / "commands.md").read_text(encoding="utf-8")
    (line,) = re.findall(r"`(eval [^`]*bash_source[^`]*)`", page)
    expected = {
        "sigmahat rep": {"report", "reproduce"},
        "sigmahat sweep --sc": {"--scenario", "--scheduler"},
        "sigmahat reproduce --scenario as": {name for name in SCENARIOS if name[:2] == "as"},
    }
    for words in expected:
        line += f"\nCOMPREPLY=(); COMP_WORDS=({words}); COMP_CWORD=$((${{#COMP_WORDS[@]}} - 1))\n"
        line += '_sigmahat_completion sigmahat; echo "${COMPREPLY[@]}"'
    programs = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    printed = run(bash, "-c", line, cwd=tmp_path, environment={"PATH": programs})
    assert [set(each.split()) for each in printed.splitlines()] == [*expected.values()]


@pytest.mark.parametrize(
    ("command", "slow"),
    [
        ("--help", "numpy fmpy matplotlib casadi scipy pyarrow bokeh dask"),
        ("check log.parquet --quiet", "pandas scipy.signal scipy.stats matplotlib bokeh"),
    ],
)
def test_a_command_imports_what_it_uses(command: str, slow: str, tmp_path: Path) -> None:
    write_log(awas_log(1.0, 0.3, 5.0), tmp_path / "log.parquet", CONFIGURATION)
    code = f"import sys, sigmahat.cli; sigmahat.cli.main({command.split()})\n"
    code += f"print({{*{slow.split()}}} & {{*sys.modules}})"
    *printed, slow_ones = run(sys.executable, "-c", code, cwd=tmp_path).splitlines()
    assert slow_ones == "set()" and (printed == []) == ("--quiet" in command)


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("reproduce --scenario tabel1", ["did you mean 'table1'?", *SCENARIOS]),
        ("reproduce --seeds 0", ["--seeds"]),
        ("compare --seeds 1.5", ["--seeds"]),
        ("reprodce", ["reproduce"]),
        ("reproduce --sedes 2", ["--seeds"]),
        ("compare --misfits AwAS", ["AwAS"]),
        ("compare --misfits --jobs 0", ["--jobs"]),
        ("sweep --modality RESIDUL", ["did you mean 'RESIDUAL'?"]),
        (f"{QUICK} --set plant.motor.D_theta", ["expected NAME=VALUES"]),
        (f"{QUICK} --seeds 0", ["--seeds"]),
        (f"{QUICK} --scenario ''", ["unknown scenario ''"]),
        (f"{QUICK} --set 'estimator.motor.B=uniform(-2,-1)'", ["every run failed"]),
        (f"{QUICK} --scheduler tcp://127.0.0.1:9", ["no Dask scheduler at tcp://127.0.0.1:9"]),
        (f"{QUICK} --scheduler nonsense", ["start one with `dask scheduler`"]),
        (f"{MOTION} --seconds 5", ["no motion of 5 s stays below the lowest resonance"]),
        (f"{MOTION} --after log.csv", ["needs CONFIG"]),
        (f"{MOTION} --seconds 1", ["5<=x<=600"]),
        (f"{MOTION} --torque -1", ["0<x<=1000000.0"]),
        (f"{MOTION} --torque nan", ["expected a number, got nan"]),
        (f"{MOTION} missing.toml", ["missing.toml"]),
        pytest.param(
            "reproduce --out /proc/sigmahat",  # a folder without write access
            ["cannot write /proc/sigmahat"],
            marks=pytest.mark.skipif(not Path("/proc/self").exists(), reason="no /proc"),
        ),
    ],
)
def test_what_does_not_fit_is_refused(command: str, words: list[str], shell: Shell) -> None:
    line = shell.refused(command)
    assert all(each in line for each in words)
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize("out", ["file", "file/below"])
def test_folder_that_is_a_file(out: str, shell: Shell) -> None:
    Path("file").write_text("mine")
    started = time.monotonic()
    line = shell.refused(f"reproduce --seeds 500 --out {out}")
    assert "got the file file" in line or "choose another folder with --out" in line
    assert time.monotonic() - started < 30  # the command fails before any computation


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_output_that_cannot_be_written(tmp_path: Path) -> None:
    command, pipe = [sys.executable, "-m", "sigmahat", "scenarios"], subprocess.PIPE
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(command, cwd=tmp_path, stdout=full, stderr=pipe, text=True)
    assert done.returncode == 2
    (line,) = done.stderr.splitlines()
    assert "cannot write the output" in line


@pytest.mark.parametrize("name", ["reproduce", "compare", "compare --misfits"])
@pytest.mark.parametrize("compiler", [None, "/usr/bin/cc"])
def test_fmus_not_built(
    name: str, compiler: str | None, shell: Shell, monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(name: str) -> Path:
        raise FileNotFoundError(name)

    monkeypatch.setattr(installed, "fmu", missing)
    monkeypatch.setattr(shutil, "which", lambda name: compiler)
    line = shell.refused(f"{name} --out out")
    assert "cmake --workflow --preset build" in line
    assert ("install a C compiler" in line) == (compiler is None)
    assert list(Path().iterdir()) == []


@pytest.mark.parametrize(
    ("name", "seeds", "delay"),
    [("reproduce", "1", 0.2), ("reproduce", "100", 1.0), ("compare", "100", 3.5)],
)
def test_interrupt(name: str, seeds: str, delay: float, tmp_path: Path) -> None:
    """The signal of Ctrl-C goes to all processes of the command, at any time after its start."""
    started = (
        "import sys, sigmahat.cli as c; run = c.cli.main; "
        "c.cli.main = lambda *a, **k: print(flush=True) or run(*a, **k); sys.exit(c.main())"
    )
    command, pipe = [sys.executable, "-c", started, name, "--seeds", seeds], subprocess.PIPE
    process = subprocess.Popen(
        command, cwd=tmp_path, stdout=pipe, stderr=pipe, text=True, start_new_session=True
    )
    assert process.stdout is not None and process.stdout.readline() == "\n"
    time.sleep(delay)
    os.killpg(process.pid, signal.SIGINT)
    output, errors = process.communicate(timeout=30)
    # If SIGINT arrives during an import, it ends Python directly, which a shell reports as 130.
    assert process.returncode in (130, -signal.SIGINT)
    assert output == ""
    assert errors.strip() == "sigmahat: interrupted"
    # Only the records of the runs that are done may remain: the next command goes on from them.
    assert {path.name for path in tmp_path.rglob("*") if path.is_file()} <= {NAME}
    if seeds == "1":
        assert list(tmp_path.iterdir()) == []
