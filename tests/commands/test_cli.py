"""The command line, as a user meets it."""

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
from gate import need
from sigmahat.cli import cli
from sigmahat.fmi import installed
from sigmahat.paper.scenarios import SCENARIOS

COMMAND = [sys.executable, "-m", "sigmahat"]


@pytest.mark.slow("a whole reproduction with its figures")
def test_reproduce_prints_the_table_and_writes_every_file(tmp_path: Path) -> None:
    done = subprocess.run([*COMMAND, "reproduce"], cwd=tmp_path, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    out = tmp_path / "sigmahat-results" / "table1"
    assert str(out) in done.stdout
    for words in ("table1", "V_a", "MODEL", "24.14", "SENSOR", "24.36", "RESIDUAL", "128.16"):
        assert words in done.stdout
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
    help_ = (cli.commands[name] if name else cli).help or ""
    (example,) = re.findall(r"Example: sigmahat (.*?)(?:\n\n|$)", help_, re.DOTALL)
    assert f"Example: sigmahat {example.split()[0]}" in printed
    first, *arguments = example.split()
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
    as_text = [{k: "" if v is None else str(v) for k, v in row.items()} for row in printed["table"]]
    assert as_text == rows


def test_bash_completes(tmp_path: Path) -> None:
    """With the line that the page says belongs into .bashrc."""
    bash = need("bash")
    page = (Path(__file__).parents[2] / "docs" / "start.md").read_text(encoding="utf-8")
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
    done = subprocess.run(
        [bash, "-c", line],
        cwd=tmp_path,
        env={**os.environ, "PATH": programs},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert [set(each.split()) for each in done.stdout.splitlines()] == [*expected.values()]


def test_help_imports_nothing_slow() -> None:
    code = (
        "import sys, sigmahat.cli; sigmahat.cli.main(['--help'])\n"
        "slow = {'numpy', 'fmpy', 'matplotlib', 'casadi', 'scipy', 'pyarrow', 'bokeh', 'dask'}\n"
        "print(sorted(slow & set(sys.modules)))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert done.stdout.splitlines()[-1] == "[]"


@pytest.mark.parametrize(
    ("command", "words"),
    [
        ("reproduce --scenario tabel1", ["did you mean 'table1'?", *SCENARIOS]),
        ("reproduce --seeds 0", ["--seeds"]),
        ("reproduce --seeds two", ["--seeds"]),
        ("compare --seeds 1.5", ["--seeds"]),
        ("reprodce", ["reproduce"]),
        ("reproduce --sedes 2", ["--seeds"]),
        pytest.param(
            "reproduce --out /proc/sigmahat",  # nobody may write there
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
    assert "file is a file" in line or "choose another folder with --out" in line
    assert time.monotonic() - started < 30  # refused before anything is computed


@pytest.mark.skipif(not Path("/dev/full").exists(), reason="no device that is always full")
def test_output_that_cannot_be_written(tmp_path: Path) -> None:
    with Path("/dev/full").open("w") as full:
        done = subprocess.run(
            [*COMMAND, "scenarios"], cwd=tmp_path, stdout=full, stderr=subprocess.PIPE, text=True
        )
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
    """Ctrl-C reaches the whole process group, at any time after the start of Python."""
    started = (
        "import sys, sigmahat.cli as c; run = c.cli.main; "
        "c.cli.main = lambda *a, **k: print(flush=True) or run(*a, **k); sys.exit(c.main())"
    )
    process = subprocess.Popen(
        [sys.executable, "-c", started, name, "--seeds", seeds],
        cwd=tmp_path,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stdout is not None and process.stdout.readline() == "\n"
    time.sleep(delay)
    os.killpg(process.pid, signal.SIGINT)
    output, errors = process.communicate(timeout=30)
    # Python ends by the signal itself if that came while it was importing; to a shell it is 130.
    assert process.returncode in (130, -signal.SIGINT)
    assert output == ""
    assert errors.strip() == "sigmahat: interrupted"
    assert list(tmp_path.iterdir()) == []
