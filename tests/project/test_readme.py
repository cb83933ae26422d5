"""What the README shows works as it says; that of the Python block is in test_examples.py."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
README = (REPOSITORY / "README.md").read_text(encoding="utf-8")


def test_the_program_is_the_example() -> None:
    (program,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert program == (REPOSITORY / "examples" / "fmpy_ten_lines.py").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "example", sorted(p.name for p in (REPOSITORY / "examples").iterdir() if p.is_file())
)
def test_every_example_is_named(example: str) -> None:
    assert f"(examples/{example})" in README
