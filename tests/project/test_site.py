"""Tests of the HTML documentation: its API reference, and its appearance in a browser.

The build of the documentation fails if Sphinx reports a warning, for example about a page outside
of the navigation or about a broken link.
"""

import re
from functools import cache
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest
from lxml import html

import sigmahat
from browser import opened

SEEN = [
    "index",
    "start",
    "parameters",
    "api",
    "filtered-regression/how-it-works",
    "gallery",
    "how-to/log",
    "genindex",
]
"""Pages that the tests open in a browser, with tables, formulas, pictures and code."""


def pages(site: Path) -> list[Path]:
    """Returns all pages of the site, without an HTML template among the files of the theme."""
    found = [page for page in site.rglob("*.html") if "_static" not in page.parts]
    assert len(found) > 20
    return found


@cache
def read(page: Path) -> Any:
    return html.parse(str(page)).getroot()


@pytest.mark.parametrize("name", sorted({*sigmahat.__all__} - {"__version__"}))
def test_a_public_name_is_on_the_page_of_the_api(name: str, site: Path) -> None:
    assert read(site / "api.html").xpath("//*[@id=$id]", id=f"sigmahat.{name}")


def test_the_site_loads_nothing_from_the_network(site: Path) -> None:
    for page in pages(site):
        loaded = read(page).xpath("//*[not(self::a)]/@src | //link[@rel='stylesheet']/@href")
        assert [link for link in loaded if urlsplit(link).netloc] == [], page.name
    for style in site.rglob("*.css"):
        text = style.read_text(encoding="utf-8")
        assert not re.search(r"""(?:@import\s+|url\()["']?(?:https?:)?//""", text), style.name


@pytest.mark.slow("eight pages in a browser, each loaded and drawn")
@pytest.mark.parametrize(("width", "dark"), [(1400, False), (400, True)], ids=["desk", "phone"])
def test_pages_fit_the_window_without_a_complaint(width: int, dark: bool, site: Path) -> None:
    with opened(site / "index.html", width, dark) as page:
        for name in SEEN:
            page.driver.get((site / f"{name}.html").as_uri())
            shown = page.run("return getComputedStyle(document.body).backgroundColor")
            brightness = sum(map(int, re.findall(r"\d+", shown)[:3])) / 3
            assert brightness < 64 if dark else brightness > 192, name
            assert page.run("return document.documentElement.scrollWidth") <= width, name
            assert page.run("return [...document.images].every(i => i.naturalWidth)"), name
        assert page.complaints() == []
        assert all(url.startswith("file:") for url in page.requests())
