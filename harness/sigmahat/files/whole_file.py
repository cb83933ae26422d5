"""Text files that are replaced at once, or not changed."""

from __future__ import annotations

import os
from pathlib import Path


def write_whole(text: str, path: Path) -> None:
    """Writes a file in UTF-8. If it is interrupted, the file is as it was before.

    Raises OSError if it cannot be written.
    """
    unfinished = path.with_name(f".{path.name}-{os.getpid()}")
    unfinished.write_text(text, encoding="utf-8")
    unfinished.replace(path)
