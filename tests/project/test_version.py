"""The files that repeat the version of pyproject.toml agree with it."""

import re
from pathlib import Path

import yaml

import sigmahat

REPOSITORY = Path(__file__).parents[2]
VERSION = sigmahat.__version__


def read(file: str) -> str:
    return (REPOSITORY / file).read_text(encoding="utf-8")


def test_the_package_that_is_tested_has_the_version_of_the_project() -> None:
    assert re.findall(r'^version = "(.*)"$', read("pyproject.toml"), re.MULTILINE) == [VERSION]


def test_the_citation_has_title_version_and_the_paper() -> None:
    citation = yaml.safe_load(read("CITATION.cff"))
    assert citation["version"] == VERSION
    assert citation["title"].startswith("sigmahat")
    (paper,) = citation["references"]
    assert (paper["type"], paper["year"]) == ("conference-paper", 2011)


def test_the_changelog_begins_with_this_version_or_with_what_comes_after_it() -> None:
    headings = re.findall(r"^## (\S+)$", read("CHANGELOG.md"), re.MULTILINE)
    assert headings[0] in (VERSION, "Unreleased") and VERSION in headings[:2]


def test_the_folder_of_the_modelica_package_has_this_version() -> None:
    named = re.findall(r"Sigmahat (\d+\.\d+\.\d+)", read("docs/how-to/modelica.md"))
    assert named and set(named) == {VERSION}
