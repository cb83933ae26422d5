"""Finds the encoding of a text, among those in which spreadsheets and data loggers write.

UTF-8 is recognised by its rules. The bytes of any other encoding are valid in several of them, and
what the decoded text looks like decides.
"""

import re
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

_ALONE = re.compile(r"[^\x00-\x7f]+")
_HALF_WIDTH = re.compile("[\uff61-\uff9f]")  # kana that Japanese text of today seldom has
_NO_CYRILLIC = re.compile("[^\x00-\x7f\u0400-\u045f\u00b0\u00b5\u00b7\u2116]")
_NO_HANGUL = re.compile("[\u3400-\u9fff]")  # Chinese characters


def _stands_alone(text: str) -> bool:
    """Whether most letters beyond ASCII are next to letters of ASCII, as in Western languages."""
    runs = _ALONE.findall(text)
    return 2 * sum(len(run) == 1 for run in runs) >= len(runs)


_EXPECTED: tuple[tuple[str, Callable[[str], bool]], ...] = (
    ("utf-8", lambda text: True),
    ("windows-1252", _stands_alone),
    ("cp932", lambda text: not _HALF_WIDTH.search(text)),  # Shift-JIS
    ("windows-1251", lambda text: not _NO_CYRILLIC.search(text)),
    ("cp949", lambda text: not _NO_HANGUL.search(text)),  # Korean
    ("gb18030", lambda text: True),  # Chinese
    ("windows-1252", lambda text: True),
)
"""Encodings in the order in which they are tried, and whether a decoded text is plausible."""


def first_lines(path: Path, count: int, longest: int) -> tuple[list[str], str] | None:
    """Reads the first lines of a text, and finds its encoding; None for a binary file.

    count    of lines
    longest  length of a line beyond which the rest of the line counts as another [characters]
    """
    for encoding, is_plausible in _EXPECTED:
        with path.open(encoding=encoding, newline="") as file, suppress(UnicodeDecodeError):
            lines = [line for _ in range(count) if (line := file.readline(longest))]
            text = "".join(lines)
            if _is_printable(text) and is_plausible(text):
                return lines, encoding
    return None


def _is_printable(text: str) -> bool:
    return all(c.isprintable() or c in "\t\r\n\ufeff\u3000" for c in text)
