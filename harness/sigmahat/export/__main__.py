"""Build steps of the FMUs, called by CMake: many processes, so each imports only what it needs."""

from pathlib import Path

import click

from sigmahat.export import amalgamation, archive, c_variables, description


@click.group()
def main() -> None:
    """Build steps of the FMUs."""


@main.command()
@click.argument("template", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@click.argument("sources", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--version", required=True, help="Version of the FMU.")
@click.option("--struct", required=True, help="C type that holds the variables.")
@click.option("--storage", required=True, type=click.Choice(list(c_variables.STORAGE)))
def describe(
    template: Path, out: Path, sources: list[Path], version: str, struct: str, storage: str
) -> None:
    """Write model descriptions and variables.h of TEMPLATE, with C files SOURCES, into OUT."""
    description.write(template, out, version, struct, c_variables.STORAGE[storage], sources)


@main.command()
@click.argument("fmu", type=click.Path(dir_okay=False, path_type=Path))
@click.argument("sources", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--fmi", required=True, type=click.IntRange(2, 3), help="Version of FMI.")
@click.option("--described", required=True, type=click.Path(path_type=Path))
@click.option("--binary", required=True, type=click.Path(path_type=Path))
@click.option("--licence", required=True, type=click.Path(path_type=Path))
@click.option("--shown", required=True, type=click.Path(path_type=Path))
def pack(
    fmu: Path,
    sources: list[Path],
    fmi: int,
    described: Path,
    binary: Path,
    licence: Path,
    shown: Path,
) -> None:
    """Write an FMU with the binary of this machine, SOURCES and the headers they include.

    --described is the folder that describe has written, --shown that of document for this version.
    """
    import fmpy

    files = description.with_headers(description.for_version(sources, fmi))
    contents = {
        "documentation/licenses/license.txt": licence,
        **{f.relative_to(shown).as_posix(): f for f in shown.rglob("*") if f.is_file()},
        **{f"sources/{f.name}": f for f in files},
    }
    if fmi == 2:
        contents["modelDescription.xml"] = described / "modelDescription.xml"
        contents[f"binaries/{fmpy.platform}/{binary.name}"] = binary
    else:
        contents["modelDescription.xml"] = described / "fmi3/modelDescription.xml"
        contents["sources/buildDescription.xml"] = described / "fmi3/buildDescription.xml"
        icons = "terminalsAndIcons/terminalsAndIcons.xml"
        contents[icons] = described / "fmi3/terminalsAndIcons.xml"
        contents[f"binaries/{fmpy.platform_tuple}/{binary.name}"] = binary
    archive.write(fmu, contents)


@main.command()
@click.argument("template", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@click.option("--version", required=True, help="Version of the FMU.")
def document(template: Path, out: Path, version: str) -> None:
    """Write documentation and icons of TEMPLATE into OUT, for both versions of FMI."""
    from sigmahat.export import documentation

    documentation.write(template, out, version)


@main.command("system")
@click.argument("ssp", type=click.Path(dir_okay=False, path_type=Path))
@click.argument("plant", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("estimator", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.option("--templates", required=True, type=click.Path(exists=True, path_type=Path))
@click.option("--version", required=True, help="Version of the system.")
def write_system(ssp: Path, plant: Path, estimator: Path, templates: Path, version: str) -> None:
    """Write SSP, the system of FMUs PLANT and ESTIMATOR that gives Table I."""
    from sigmahat.export import system

    system.write(ssp, plant, estimator, templates, version)


@main.command()
@click.argument("fmu", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--cache", required=True, type=click.Path(file_okay=False, path_type=Path))
def release(fmu: Path, out: Path, cache: Path) -> None:
    """Write OUT: the FMU with the binaries of every platform, compiled from its sources."""
    from sigmahat.export import cross_compiler

    cross_compiler.release(fmu, out, cache)


@main.command()
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@click.argument("contents", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--project", required=True, type=click.Path(exists=True, path_type=Path))
@click.option("--source", multiple=True, required=True, type=click.Path(path_type=Path))
@click.option("--include", multiple=True, required=True, type=click.Path(path_type=Path))
@click.option("--cache", required=True, type=click.Path(file_okay=False, path_type=Path))
def distribute(
    out: Path,
    contents: list[Path],
    project: Path,
    source: list[Path],
    include: list[Path],
    cache: Path,
) -> None:
    """Write wheels with CONTENTS, released FMUs, and the source distribution into OUT."""
    from sigmahat.export import distribution

    distribution.write(out, project, contents, source, include, cache)


@main.command("bill")
@click.argument("folder", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.option("--version", required=True, help="Version of the release.")
def write_bill(folder: Path, version: str) -> None:
    """Write the bill of materials of the release in FOLDER into it."""
    from sigmahat.export import bill

    bill.write(folder / bill.NAME, folder, version)


@main.command()
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@click.argument("fmus", nargs=-1, required=True, type=click.Path(exists=True, path_type=Path))
@click.option("--page", required=True, type=click.Path(exists=True, path_type=Path))
@click.option("--cache", required=True, type=click.Path(file_okay=False, path_type=Path))
def live(out: Path, fmus: list[Path], page: Path, cache: Path) -> None:
    """Write the folder PAGE with FMUS as WebAssembly into OUT."""
    from sigmahat.export import web

    web.write(out, page, list(fmus), cache)


@main.command()
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@click.argument("sources", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--interface", required=True, type=click.Path(path_type=Path))
@click.option("--licence", required=True, type=click.Path(path_type=Path))
@click.option("--version", required=True, help="Version of the library.")
def amalgamate(
    out: Path, sources: list[Path], interface: Path, licence: Path, version: str
) -> None:
    """Write sigmahat.h, all of the header INTERFACE, and sigmahat.c, all SOURCES, into OUT."""
    amalgamation.write(out, sources, interface, licence, version)


@main.command("parameters")
@click.argument("template", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
def write_parameters(template: Path, out: Path) -> None:
    """Write OUT, the parameters of TEMPLATE as a table in C."""
    out.write_text(c_variables.parameter_table(template), encoding="utf-8")


@main.command("modelica")
@click.argument("out", type=click.Path(dir_okay=False, path_type=Path))
@click.argument("library", type=click.Path(exists=True, file_okay=False, path_type=Path))
@click.argument("sources", nargs=-1, required=True, type=click.Path(path_type=Path))
@click.option("--templates", required=True, type=click.Path(exists=True, path_type=Path))
@click.option("--licence", required=True, type=click.Path(path_type=Path))
@click.option("--version", required=True, help="Version of the package.")
def write_modelica(
    out: Path, library: Path, sources: list[Path], templates: Path, licence: Path, version: str
) -> None:
    """Write OUT, an archive of the Modelica package LIBRARY with the C files SOURCES.

    --templates is the folder of the model descriptions, from which it has its variables.
    """
    from sigmahat.export import modelica

    modelica.write(out, library, templates, sources, licence, version)


main()
