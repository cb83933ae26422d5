"""The README shows the examples. test_examples.py checks what its Python program prints."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

REPOSITORY = Path(__file__).parents[2]
README = (REPOSITORY / "README.md").read_text(encoding="utf-8")


def test_the_program_of_the_readme_is_the_example() -> None:
    (program,) = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
    assert program == (REPOSITORY / "examples" / "fmpy_ten_lines.py").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    "example", sorted(p.name for p in (REPOSITORY / "examples").iterdir() if p.is_file())
)
def test_the_readme_names_every_example(example: str) -> None:
    assert f"(examples/{example})" in README
