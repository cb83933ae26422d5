"""Build steps of the FMUs, called by CMake."""

from pathlib import Path

import click
import fmpy

from sigmahat.export import archive, description


@click.group()
def main() -> None:
    """Build steps of the FMUs."""


@main.command()
@click.argument("template", type=click.Path(exists=True, dir_okay=False, path_type=Path))
@click.argument("out", type=click.Path(file_okay=False, path_type=Path))
@click.option("--version", required=True, help="Version of the FMU.")
@click.option("--struct", required=True, help="C type that holds the variables.")
@click.option("--arrays", is_flag=True, help="Variables are in the arrays p, u and y of a plant.")
def describe(template: Path, out: Path, version: str, struct: str, arrays: bool) -> None:
    """Write modelDescription.xml and variables.h of TEMPLATE into OUT."""
    storage = description.storage_in_arrays if arrays else description.storage_in_structs
    description.write(template, out, version, struct, storage)


@main.command()
@click.argument("fmu", type=click.Path(dir_okay=False, path_type=Path))
@click.option("--description", "xml", required=True, type=click.Path(path_type=Path))
@click.option("--binary", required=True, type=click.Path(path_type=Path))
@click.option("--licence", required=True, type=click.Path(path_type=Path))
def pack(fmu: Path, xml: Path, binary: Path, licence: Path) -> None:
    """Write an FMU with the binary of this machine."""
    archive.write(
        fmu,
        {
            "modelDescription.xml": xml,
            f"binaries/{fmpy.platform}/{binary.name}": binary,
            "documentation/licenses/LICENSE.txt": licence,
        },
    )


main()
