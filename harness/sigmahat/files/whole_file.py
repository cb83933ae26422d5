"""Reads small files as a whole, with a limit."""

import errno
from pathlib import Path


def read_whole(path: Path, longest: int) -> str:
    """Reads a text in UTF-8 of at most this number of bytes.

    Raises OSError if the file cannot be read, and ValueError if it is no text or longer.
    """
    if path.exists() and not path.is_file():  # reading a pipe would wait
        raise OSError(errno.EINVAL, "expected a file, got a folder, a pipe or a device")
    with path.open("rb") as file:
        content = file.read(longest + 1)
    if len(content) > longest:
        raise ValueError(f"expected at most {longest} bytes, got more: is it the log?")
    return content.decode()
