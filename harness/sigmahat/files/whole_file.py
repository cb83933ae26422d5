"""Text files that are replaced at once, or not changed."""

from __future__ import annotations

from pathlib import Path

from sigmahat.files.output_folder import unfinished_folder


def write_whole(text: str, path: Path) -> None:
    """Writes a file in UTF-8. If it is interrupted, the file is as it was before.

    A link stays a link to the file. Raises OSError if it cannot be written.
    """
    if path.exists() and not path.is_file():  # such as /dev/stdout; a folder is refused
        path.write_text(text, encoding="utf-8")
        return
    file = path.resolve()
    try:
        with unfinished_folder(file.parent) as folder:
            (folder / file.name).write_text(text, encoding="utf-8")
    except OSError as error:  # it names what nobody has heard of
        raise OSError(error.errno, error.strerror, str(path)) from error
