"""Writes the description of an FMU for FMI 2.0 and 3.0, and its table of variables in C."""

from collections.abc import Iterable
from pathlib import Path
from xml.etree.ElementTree import SubElement

from sigmahat.plant_fmu import model_description
from sigmahat.plant_fmu.c_variables import c_table
from sigmahat_build import fmi3_description
from sigmahat_build.c_files import for_version
from sigmahat_build.description_template import render
from sigmahat_build.storage import STORAGE


def write(
    template: Path, out: Path, version: str, struct: str, storage: str, sources: Iterable[Path]
) -> None:
    """Write ``modelDescription.xml`` and ``variables.h`` of a template into a folder.

    struct   C type that holds the variables
    storage  how the type holds them, a key of ``STORAGE``

    The folder ``fmi3`` gets the three files that describe the FMU for FMI 3.0. ``sources`` are the
    C files of both versions; files in a folder ``fmi2`` or ``fmi3`` are for that version only.
    """
    out.mkdir(parents=True, exist_ok=True)
    root = render(template, version)
    sources = [file for file in sources if file.suffix == ".c"]  # only these are compiled
    listed = SubElement(root.findall("CoSimulation")[0], "SourceFiles")
    for file in for_version(sources, 2):
        SubElement(listed, "File", name=file.name)
    guid = model_description.complete(root)
    places = STORAGE[storage](root)
    table = c_table(root, struct, places, guid)
    (out / "variables.h").write_text(table, encoding="utf-8")
    model_description.write_xml(root, out / "modelDescription.xml")
    names = [file.name for file in for_version(sources, 3)]
    files = {
        "modelDescription.xml": fmi3_description.for_fmi3(root),
        "buildDescription.xml": fmi3_description.build_description(template.stem, names),
        "terminalsAndIcons.xml": fmi3_description.terminals_and_icons(root),
    }
    (out / "fmi3").mkdir(exist_ok=True)
    for name, content in files.items():
        model_description.write_xml(content, out / "fmi3" / name)
