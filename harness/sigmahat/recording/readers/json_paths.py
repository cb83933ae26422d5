"""Finds the paths to the values of JSON Lines before they are parsed.

A parser that makes columns nests its calls as deeply as the objects are nested, and gives each path
a value in every row. A small file with ever new names, or with brackets alone, would end it.
"""

import re
from pathlib import Path

from sigmahat.recording.limits import check_columns, check_together
from sigmahat.recording.log import LogError

DEEPEST = 32  # largest number of nested objects and arrays
LONGEST_LINE = 1 << 20  # bytes
_MOST_FORMS = 10_000  # lines of different forms that are remembered
_TOKEN = re.compile(rb'"[^"\\]*(?:\\.[^"\\]*)*(?:"\s*:?)?|[{}\[\]]', re.DOTALL)
"""A text, a name with its colon, or a bracket; a text that is not closed ends with the line, so
that the time grows with the length of a line only."""


def check_paths(path: Path) -> None:
    """Raises LogError for lines that are too long, too deep or no UTF-8, or too many values."""
    rows, paths, forms = 0, set[bytes](), set[bytes]()
    with path.open("rb") as file:
        while line := file.readline(LONGEST_LINE + 1):
            rows += 1
            if len(line) > LONGEST_LINE:
                raise LogError(
                    f"{path}: expected lines of at most {LONGEST_LINE} bytes; see line {rows}"
                )
            tokens = [each for each in _TOKEN.findall(line) if each[-1:] != b'"']
            form = b"".join(tokens)
            if form in forms:
                continue
            if len(forms) < _MOST_FORMS:
                forms.add(form)
            try:
                form.decode()
            except UnicodeDecodeError as error:
                raise LogError(
                    f"{path}: expected names in UTF-8; save it in UTF-8; see line {rows}"
                ) from error
            _add_paths(path, tokens, paths)
            check_columns(path, len(paths))
    check_together(path, rows * len(paths))


def _add_paths(path: Path, tokens: list[bytes], paths: set[bytes]) -> None:
    """Adds the paths to the names of a line; raises LogError if it nests too deeply."""
    outer: list[bytes] = []  # path of each open bracket
    name = b""
    for token in tokens:
        if token in (b"{", b"["):
            outer.append(name)
            if len(outer) > DEEPEST:
                raise LogError(f"{path}: expected at most {DEEPEST} levels of objects, got more")
        elif token in (b"}", b"]"):
            name = outer.pop() if outer else b""
        else:
            name = (outer[-1] if outer else b"") + b"." + token
            paths.add(name)
