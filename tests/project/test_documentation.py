"""Documentation and icons inside the FMUs."""

from __future__ import annotations

import re
import zipfile
from typing import Any

import pytest
from lxml import etree

import sigmahat
from fmi_runs import ESTIMATORS, PLANTS

INDEX = "documentation/index.html"
ICON = "documentation/icon.svg"


@pytest.fixture(scope="module", params=ESTIMATORS + PLANTS)
def files(request: pytest.FixtureRequest) -> dict[str, bytes]:
    """Contents of an FMU by name."""
    with zipfile.ZipFile(sigmahat.fmu(request.param)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def text(element: Any) -> str:
    """The text that a reader sees, without the items of an enumeration."""
    parts = [element.text or ""]
    parts += [text(e) + (e.tail or "") for e in element if e.get("class") != "items"]
    return "".join(parts)


def test_the_tables_list_the_variables_of_the_model_description(files: dict[str, bytes]) -> None:
    page = etree.fromstring(files[INDEX])
    rows = {}
    for row in page.iterfind(".//tbody/tr"):
        name, unit, start, limits, variability, description = map(text, row)
        assert name not in rows
        rows[name] = (unit, start, limits, variability, description)
    variables = etree.fromstring(files["modelDescription.xml"]).findall("ModelVariables/*")
    assert set(rows) == {v.get("name") for v in variables}
    for v in variables:
        unit, start, limits, variability, description = rows[v.get("name")]
        assert unit == v[0].get("unit", "")
        assert (variability, description) == (v.get("variability"), v.get("description"))
        for limit in (v[0].get("min"), v[0].get("max")):
            assert limit is None or limit in limits
        if v[0].tag == "Real" and v[0].get("start") is not None:
            assert float(start.split()[0]) == pytest.approx(float(v[0].get("start")), rel=1e-5)
        else:
            assert bool(start) == (v[0].get("start") is not None)


def test_enumerations_are_listed_with_their_items(files: dict[str, bytes]) -> None:
    page = etree.fromstring(files[INDEX])
    root = etree.fromstring(files["modelDescription.xml"])
    for enumeration in root.iterfind("ModelVariables/*/Enumeration"):
        name = enumeration.getparent().get("name")
        (row,) = [r for r in page.iterfind(".//tbody/tr") if text(r[0]) == name]
        path = f"TypeDefinitions/SimpleType[@name='{enumeration.get('declaredType')}']//Item"
        items = [
            (f"{item.get('value')} {item.get('name')}", item.get("description"))
            for item in root.iterfind(path)
        ]
        found = [e.text for e in row.iterfind(".//dl[@class='items']/*")]
        assert found == [part for item in items for part in item]
        if enumeration.get("start") is None:  # an output
            assert text(row[2]) == ""
        else:
            assert f"{enumeration.get('start')} {text(row[2])}" in [title for title, _ in items]


def test_every_name_in_the_text_is_a_variable(files: dict[str, bytes]) -> None:
    """Checks names in `code` outside of the tables, because that text is written by hand."""
    page = etree.fromstring(files[INDEX])
    root = etree.fromstring(files["modelDescription.xml"])
    names = {v.get("name") for v in root.iterfind("ModelVariables/*")}
    names |= {re.sub(r"_1\b", "_i", name) for name in names}
    names |= {name.split("[")[0] for name in names}
    checked = 0
    for code in page.iterfind(".//code"):
        if code.xpath("ancestor::table | ancestor::summary") or code.text[0] in "._":
            continue
        name = code.text.removesuffix(".*")
        assert name in names or any(n.startswith(f"{name}.") for n in names), name
        checked += 1
    assert checked > 5


def test_the_page_loads_nothing_from_outside_of_the_fmu(files: dict[str, bytes]) -> None:
    """It can be opened offline: it refers only to files of the FMU, and to anchors that exist."""
    for name in (INDEX, ICON):
        content = files[name].decode()
        root = etree.fromstring(files[name])
        assert not root.findall(".//{*}script") and "@import" not in content
        for url in re.findall(r"url\(([^)]*)\)", content):
            assert url.strip("\"'").startswith("#")
        for element in root.iter(etree.Element):
            for key, value in element.attrib.items():
                if etree.QName(key).localname not in ("src", "href", "srcset", "data", "action"):
                    continue
                if value.startswith("#"):
                    assert root.xpath("//*[@id=$id]", id=value[1:]), value
                else:
                    assert f"documentation/{value}" in files, value
