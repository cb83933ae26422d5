"""The program of docs/how-to/joint.md works as it stands."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from command_line import Shell
from recorded_logs import REGRESSION, awas_log, write_log
from sigmahat.cli import cli

PAGE = Path(__file__).parents[2] / "docs" / "how-to" / "joint.md"


@pytest.mark.slow("replays logs five times, with --start-from and validate")
def test_the_commands_and_the_program_of_the_page(shell: Shell) -> None:
    write_log(awas_log(1.0, 0.3, 3.0), Path("knee.csv"))
    write_log(awas_log(1.3, 0.3, 3.0, seed=2), Path("second.csv"))
    Path("knee.toml").write_text(REGRESSION)
    text = PAGE.read_text(encoding="utf-8")
    (commands,) = re.findall(r"^```sh\n(.*?)^```$", text, re.M | re.S)
    for line in commands.splitlines():
        program, name, *_ = line.split()
        assert program == "sigmahat" and name in cli.commands
        shell.run(line.partition("#")[0].removeprefix("sigmahat "))
    assert Path("both/joint.ssv").is_file()
    (program,) = re.findall(r"^```python\n(.*?)^```$", text, re.M | re.S)
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
