"""Writes FMU archives whose bytes depend only on the contents."""

import zipfile
from collections.abc import Mapping
from pathlib import Path

from sigmahat.files.output import whole_file

# Zip has no time zone and starts in 1980; any fixed time would do.
_TIME = (1980, 1, 1, 0, 0, 0)


def write(fmu: Path, contents: Mapping[str, Path | bytes]) -> None:
    """Write an FMU from files or bytes, given by their names in the archive.

    Entries are sorted, with fixed times and permissions, so that equal contents give equal
    bytes. Raises ``FileNotFoundError`` for a missing file, before anything is written.
    """
    data = {
        name: content if isinstance(content, bytes) else content.read_bytes()
        for name, content in contents.items()
    }
    fmu.parent.mkdir(parents=True, exist_ok=True)
    with whole_file(fmu) as whole, zipfile.ZipFile(whole, "w") as archive:
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
