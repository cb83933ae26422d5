"""Would the tests of the library notice a wrong token?"""

from __future__ import annotations

import shutil
from pathlib import Path

import mutation
from gate import missing


def test_nearly_every_wrong_token_is_noticed(tmp_path: Path) -> None:
    if shutil.which("gcc") is None:
        missing("gcc", "apt-get install gcc")
    outcome = mutation.run(tmp_path)
    assert len(outcome.killed) + len(outcome.survived) + len(outcome.equivalent) >= 60
    assert outcome.share() >= mutation.ASKED, "\n".join(map(str, outcome.survived))
