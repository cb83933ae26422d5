"""Files and functions that the documentation names exist. Sphinx checks the links."""

import re
from functools import cache
from pathlib import Path

import pytest

from c_sources import REPOSITORY
from controllers import run
from gate import need

PAGES = sorted(
    page
    for page in REPOSITORY.glob("**/*.md")
    if "build" not in page.parts and page.stem != "CHANGELOG"
)
FILE = re.compile(r"`([\w./-]+\.(?:c|h|py|toml|xml|js|mo|cmake))`")
NOT_OURS = re.compile(
    r"NAME|Name|LOG|^build/|modelDescription\.xml|buildDescription\.xml|^(rls|fmpy/simulation|joint|"
    r"arm|arm-elbow|motion|knee\.draft|desr)\.\w+$"
)
"""Names that are no files of the repository: placeholders, files of users, and rls.c."""


@cache
def tracked() -> list[str]:
    return run(need("git"), "-C", REPOSITORY, "ls-files").splitlines()


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(REPOSITORY)))
def test_every_file_exists(page: Path) -> None:
    named = set(FILE.findall(page.read_text(encoding="utf-8")))
    known = {name for name in named for file in tracked() if f"/{file}".endswith(f"/{name}")}
    assert {name for name in named - known if not NOT_OURS.search(name)} == set()


def test_every_function_of_the_library_exists() -> None:
    code = "\n".join(
        (REPOSITORY / file).read_text(encoding="utf-8")
        for file in tracked()
        if file.startswith(("c/", "fmu_src/", "harness/native/", "modelica/"))
        and file.endswith((".c", ".h"))
    )
    for page in PAGES:
        named = set(re.findall(r"\bsh_\w*[a-z]\b", page.read_text(encoding="utf-8")))
        assert {name for name in named if name not in code and "NAME" not in name} == set(), page


def test_every_cited_equation_and_section_of_filtered_regression_exists() -> None:
    """The comments of the C code cite the derivation: equations (F1), (F2) ..., and sections."""
    page = (REPOSITORY / "docs/filtered-regression/how-it-works.md").read_text(encoding="utf-8")
    equations = re.findall(r"\\text\{\(F(\d+)\)\}", page)
    assert equations == [str(n + 1) for n in range(len(equations))]
    sections = set(re.findall(r"^#+ (\d+(?:\.\d+)?) ", page, re.MULTILINE))
    cited = 0
    for file in (REPOSITORY / "c" / "filtered_regression").iterdir():
        text = file.read_text(encoding="utf-8")
        for number in re.findall(r"\(F(\d+)\)", text):
            assert number in equations, (file.name, number)
            cited += 1
        for number in re.findall(r"[Ss]ections? (\d+(?:\.\d+)?)", text):
            assert number in sections, (file.name, number)
    assert cited > 20
