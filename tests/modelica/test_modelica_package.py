"""The Modelica package: parsers read it, every class is documented, the archive is complete."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path
from zipfile import ZipFile

import pymoca.ast
import pymoca.parser
import pytest
import rumoca
from lxml import etree

import sigmahat
from modelica_package import FILES, PACKAGE, REPOSITORY, classes, compiled

FOLDER = f"Sigmahat {sigmahat.__version__}"
C_SOURCES = f"{FOLDER}/Resources/C-Sources"


def by_rumoca(file: Path) -> None:
    found = rumoca.validate(file)
    assert found == [], [each.message for each in found]


def by_pymoca(file: Path) -> None:
    assert pymoca.parser.parse(file.read_text(encoding="utf-8")) is not None


def by_antlr(file: Path) -> None:
    """The parser of modelica-builder, from the grammar of ANTLR."""
    if sys.version_info >= (3, 14):
        pytest.skip("modelica-builder is for Python below 3.14")
    from modelica_builder.modelica_parser import parse

    _, parser = parse(str(file))
    assert parser.getNumberOfSyntaxErrors() == 0


def by_modelica(file: Path) -> None:
    if sys.version_info < (3, 12):
        pytest.skip("the package modelica is for Python 3.12 and newer")
    from modelica.lang import parse

    parse(file.read_text(encoding="utf-8"))


each_parser = pytest.mark.parametrize("parse", [by_rumoca, by_pymoca, by_antlr, by_modelica])


@each_parser
def test_every_file_is_read_without_error(parse: Callable[[Path], None]) -> None:
    for file in FILES:
        parse(file)


@each_parser
def test_a_damaged_file_is_refused(parse: Callable[[Path], None], tmp_path: Path) -> None:
    damaged = tmp_path / "AwasPlant.mo"
    text = (PACKAGE / "Plants" / "AwasPlant.mo").read_text(encoding="utf-8")
    damaged.write_text(text.replace("phi = q - theta;", "phi = q - ;"), encoding="utf-8")
    refused = False
    try:
        parse(damaged)
    except Exception:  # each parser has its own; pymoca returns None
        refused = True
    assert refused


def test_the_order_of_a_package_names_all_that_is_in_it() -> None:
    for package in PACKAGE.rglob("package.mo"):
        folder = package.parent
        inside = {file.stem for file in folder.glob("*.mo")} - {"package"}
        inside |= {each.parent.name for each in folder.glob("*/package.mo")}
        order = (folder / "package.order").read_text(encoding="utf-8").split()
        assert len(order) == len(set(order)) and set(order) == inside, folder


def named(annotation: pymoca.ast.ClassModification | None) -> set[str]:
    arguments = annotation.arguments if annotation else []
    return {str(each.value.component) for each in arguments}


def test_every_class_has_a_description_a_documentation_and_an_icon() -> None:
    for name, each in classes().items():
        if each.type == "type":
            assert name.startswith("Types.")
            continue
        if each.replaceable:  # a parameter of a plant, as it were
            continue
        assert each.comment, name
        if each.is_short_class_definition:  # pymoca does not keep their annotations
            text = (PACKAGE / "Interfaces.mo").read_text(encoding="utf-8")
            text = text.split(f"connector {each.name} =")[1].split("connector ")[0]
            assert "Icon(" in text and "Documentation(" in text
            continue
        assert "Documentation" in named(each.annotation), name
        own = "Icon" in named(each.annotation)
        # By inheritance; records and functions extend those that have one.
        assert own or each.extends, name


def test_the_documentation_is_html_whose_links_lead_to_classes() -> None:
    known = {"Sigmahat", *(f"Sigmahat.{name}" for name in classes())}
    pages = 0
    for file in FILES:
        text = file.read_text(encoding="utf-8")
        for info in re.findall(r'Documentation\(\s*info="(.*?[^\\])"\)', text, re.DOTALL):
            page = etree.fromstring(info.replace('\\"', '"'))
            assert page.tag == "html"
            assert {
                link.get("href").removeprefix("modelica://") for link in page.iter("a")
            } <= known
            pages += 1
        assert text.count("Documentation(") == len(re.findall("Documentation\\(info=", text))
    assert pages == sum(file.read_text(encoding="utf-8").count("info=") for file in FILES)


def test_every_example_says_how_it_is_run() -> None:
    examples = {name: each for name, each in classes().items() if name.startswith("Examples.")}
    assert len(examples) == 6
    for name, each in examples.items():
        assert "experiment" in named(each.annotation), name


@pytest.fixture(scope="module")
def archive(build: Path) -> Path:
    return build / "release" / "sigmahat-modelica.zip"


def test_the_archive_has_the_package_and_all_of_its_c(archive: Path) -> None:
    with ZipFile(archive) as opened:
        names = set(opened.namelist())
        assert {name.split("/")[0] for name in names} == {FOLDER}
        assert {f"{FOLDER}/{file.relative_to(PACKAGE).as_posix()}" for file in FILES} <= names
        assert f"{FOLDER}/LICENSE" in names
        text = "".join(file.read_text(encoding="utf-8") for file in FILES)
        included = set(re.findall(r'Include="#include \\"(.+?)\\""', text))
        assert len(included) == 4
        for name in included:
            waiting, seen = [name], set()
            while waiting:
                file = waiting.pop()
                seen.add(file)
                source = opened.read(f"{C_SOURCES}/{file}").decode()
                waiting += set(re.findall(r'^#include "(.+)"', source, re.M)) - seen
                # The tool has it.
                waiting = [each for each in waiting if each != "ModelicaUtilities.h"]


EXAMPLES = sorted({file.stem for file in (PACKAGE / "Examples").glob("*.mo")} - {"package"})
WITH_ESTIMATORS = ("Antagonistic", "Table1", "page")
PAGE = REPOSITORY / "docs" / "how-to" / "modelica.md"


def text_of(example: str) -> tuple[str, str]:
    """Text and name of a model: an example, or the one on the page."""
    if example != "page":
        return f"model Test extends Sigmahat.Examples.{example}; end Test;", "Test"
    found = re.search(r"```modelica\n(model (\w+)\n.*?)```", PAGE.read_text(encoding="utf-8"), re.S)
    assert found
    return found[1], found[2]


@pytest.mark.parametrize("example", [*EXAMPLES, "page"])
def test_rumoca_compiles_every_example_as_far_as_it_can(example: str) -> None:
    """It knows no external objects: with an estimator it ends there, after names and arguments."""
    if example in WITH_ESTIMATORS:
        with pytest.raises(rumoca.CompileError, match=r"ToDae.* unsupported type `Estimator`"):
            compiled(*text_of(example))
    else:
        assert compiled(*text_of(example)).structure().is_balanced
