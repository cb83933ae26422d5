"""Packs an FMU from its binary, its C files and the files that describe it."""

from collections.abc import Iterable
from pathlib import Path

import fmpy

from sigmahat.plant_fmu import archive
from sigmahat_build.c_files import for_version, with_headers


def pack(
    fmu: Path,
    sources: Iterable[Path],
    fmi: int,
    described: Path,
    binary: Path,
    licence: Path,
    shown: Path,
) -> None:
    """Write an FMU with the binary of this machine, C files and the headers they include.

    fmi        version of FMI, 2 or 3
    described  folder that ``descriptions`` wrote; shown: folder that ``documentation`` wrote
    """
    files = with_headers(for_version(sources, fmi))
    contents: dict[str, Path | bytes] = {
        "documentation/licenses/license.txt": licence,
        **archive.files_in(shown),
        **{f"sources/{file.name}": file for file in files},
    }
    platform = fmpy.platform if fmi == 2 else fmpy.platform_tuple
    contents[f"binaries/{platform}/{binary.name}"] = binary
    folder = described if fmi == 2 else described / "fmi3"
    contents["modelDescription.xml"] = folder / "modelDescription.xml"
    if fmi == 3:
        contents["sources/buildDescription.xml"] = folder / "buildDescription.xml"
        icons = "terminalsAndIcons.xml"
        contents[f"terminalsAndIcons/{icons}"] = folder / icons
    archive.write(fmu, contents)
