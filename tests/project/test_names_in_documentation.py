"""Files and functions that the documentation names exist. The build of the site checks links."""

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
"""Places of names, files of FMUs and of users, and the parameter rls.c."""


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
