"""Writes FMU archives whose bytes depend only on the contents."""

import zipfile
from collections.abc import Iterable, Mapping
from pathlib import Path

from sigmahat.export import description

# Zip has no time zone and starts in 1980; any fixed time would do.
_TIME = (1980, 1, 1, 0, 0, 0)


def write(fmu: Path, contents: Mapping[str, Path | bytes]) -> None:
    """Write an FMU from files or bytes, given by their names in the archive.

    Entries are sorted, with fixed times and permissions, so that equal contents give equal
    bytes. Raises ``FileNotFoundError`` for a missing file, before anything is written.
    """
    data = {
        name: each if isinstance(each, bytes) else each.read_bytes()
        for name, each in contents.items()
    }
    fmu.parent.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(fmu, "w") as archive:
        for name in sorted(data):
            entry = zipfile.ZipInfo(name, _TIME)
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.create_system = 3  # Unix, whose permission bits follow
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, data[name])


def files_in(folder: Path) -> dict[str, Path | bytes]:
    """Finds all files in a folder, at any depth, by their relative names."""
    files = (file for file in folder.rglob("*") if file.is_file())
    return {file.relative_to(folder).as_posix(): file for file in files}


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
    described  folder that ``description.write`` wrote; shown: folder that ``documentation`` wrote
    """
    import fmpy

    files = description.with_headers(description.for_version(sources, fmi))
    contents: dict[str, Path | bytes] = {
        "documentation/licenses/license.txt": licence,
        **files_in(shown),
        **{f"sources/{f.name}": f for f in files},
    }
    platform = fmpy.platform if fmi == 2 else fmpy.platform_tuple
    contents[f"binaries/{platform}/{binary.name}"] = binary
    folder = described if fmi == 2 else described / "fmi3"
    contents["modelDescription.xml"] = folder / "modelDescription.xml"
    if fmi == 3:
        contents["sources/buildDescription.xml"] = folder / "buildDescription.xml"
        icons = "terminalsAndIcons.xml"
        contents[f"terminalsAndIcons/{icons}"] = folder / icons
    write(fmu, contents)
