"""Documentation and icons inside the FMUs."""

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
    with zipfile.ZipFile(sigmahat.fmu(request.param)) as archive:
        return {name: archive.read(name) for name in archive.namelist()}


def text(element: Any) -> str:
    """The text that a reader sees, without the items of an enumeration."""
    return "".join(element.xpath(".//text()[not(ancestor::*[@class='items'])]"))


def test_the_tables_list_the_variables_of_the_model_description(files: dict[str, bytes]) -> None:
    rows: dict[str, tuple[Any, ...]] = {}
    for row in etree.fromstring(files[INDEX]).iterfind(".//tbody/tr"):
        name, *cells = map(text, row)
        assert name not in rows
        rows[name] = (*cells, [e.text for e in row.iterfind(".//dl[@class='items']/*")])
    root = etree.fromstring(files["modelDescription.xml"])
    variables = root.findall("ModelVariables/*")
    assert set(rows) == {v.get("name") for v in variables}
    for v in variables:
        unit, start, limits, variability, description, listed = rows[v.get("name")]
        assert unit == v[0].get("unit", "")
        assert (variability, description) == (v.get("variability"), v.get("description"))
        for limit in (v[0].get("min"), v[0].get("max")):
            assert limit is None or limit in limits
        items = f"TypeDefinitions/SimpleType[@name='{v[0].get('declaredType')}']//Item"
        expected = {
            f"{item.get('value')} {item.get('name')}": item.get("description")
            for item in root.iterfind(items)
        }
        assert listed == [part for item in expected.items() for part in item]
        if v[0].get("start") is None:
            assert start == ""
        elif v[0].tag == "Real":
            assert float(start.split()[0]) == pytest.approx(float(v[0].get("start")), rel=1e-5)
        elif expected:
            assert f"{v[0].get('start')} {start}" in expected
        else:
            assert start


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
    """The manual can be opened offline: it refers only to files of the FMU and existing anchors."""
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
