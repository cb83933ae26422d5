"""Every package has a lowest version, and requirements/lowest.txt has exactly these versions."""

import re
import sys
from collections import defaultdict
from collections.abc import Iterator
from pathlib import Path

import pytest
from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from packaging.version import Version

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

REPOSITORY = Path(__file__).parents[2]
PROJECT = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))


def requirements() -> Iterator[Requirement]:
    """Yields every requirement of pyproject.toml."""
    extras, groups = PROJECT["project"]["optional-dependencies"], PROJECT["dependency-groups"]
    lists = [PROJECT["build-system"]["requires"], PROJECT["project"]["dependencies"]]
    for each in (*lists, *extras.values(), *groups.values()):
        yield from (Requirement(text) for text in each if isinstance(text, str))


def lowest(requirement: Requirement) -> Version | None:
    """Returns the lower bound of a requirement, or None without one."""
    bounds = [s.version for s in requirement.specifier if s.operator in (">=", "==", "~=")]
    return Version(bounds[0]) if bounds else None


def test_every_requirement_has_a_lower_bound() -> None:
    assert [str(each) for each in requirements() if lowest(each) is None] == []


def test_a_package_has_the_same_lower_bound_everywhere() -> None:
    bounds = defaultdict(set)
    for each in requirements():
        bounds[canonicalize_name(each.name)].add(lowest(each))
    assert {name: found for name, found in bounds.items() if len(found) > 1} == {}


def test_the_run_with_the_lowest_versions_has_the_lower_bounds() -> None:
    """GIVEN requirements/lowest.txt
    THEN no bound is lower than a version that the tests run with.
    """
    text = (REPOSITORY / "requirements" / "lowest.txt").read_text(encoding="utf-8")
    pinned = defaultdict(set)
    for name, version in re.findall(r"^([a-z0-9-]+)==([^ \n]+)", text, re.M):
        pinned[name].add(Version(version))
    extras = PROJECT["project"]["optional-dependencies"].values()
    texts = [*PROJECT["project"]["dependencies"], *(text for extra in extras for text in extra)]
    for each in map(Requirement, texts):
        assert min(pinned[canonicalize_name(each.name)]) == lowest(each), each


@pytest.mark.parametrize(
    ("name", "version"),
    [
        ("pyarrow", "14.0.0"),  # a Parquet file runs code: CVE-2023-47248
        ("lxml", "6.0.4"),  # an XML file names other files that are read: CVE-2026-41066
        ("bokeh", "3.8.1"),  # a foreign page talks to the server: CVE-2026-21883
    ],
)
def test_no_version_with_a_known_weakness_is_allowed(name: str, version: str) -> None:
    (requirement,) = (each for each in requirements() if each.name == name)
    assert not requirement.specifier.contains(version)
