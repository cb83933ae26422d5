"""Texts that end strings, comments and elements, and what of them stands outside of these.

The rules of each language are those of its standard, and none of the package's own code is used.
"""

import random
import re
from collections.abc import Callable, Iterator
from html.parser import HTMLParser
from typing import Any

from lxml import etree

MARK = "pwned"  # word in each hostile text, which is in no other text
_PIECES = (
    *("'", '"', '"""', "'''", "\n", "\r", "\r\n", "\\", "\\\n", "]]>", "-->", "--", "--!>", "<!--"),
    *(
        "*/",
        "/*",
        "//",
        "%",
        "%{",
        "%}",
        "...",
        ";",
        "#",
        "#=",
        "[x]\n",
        "=",
        "{{",
        "}}",
        "${",
        "`",
    ),
    *("<script>", "</script>", "<img src=x onerror=", "<plugin filename='", "<?php", "?>", "&lt;"),
    *("&", ">", "<", "\0", "\x07", "\x0b", "\x0c", "\x1b[31m", "\x7f", "\x85", "\u2028", "\u2029"),
    *("\u202e", "\u200b", "\ufeff", "\ufffe", "\ud800", "\U0001f600", "$", "$$", "^", "_", "/../"),
    *(" ", ": ", "- ", "=cmd|", "javascript:", "system('", "??/", "Ärger", "ß", "x" * 100),
)
_LONG = 20_000


def hostile(draw: random.Random) -> str:
    """Draws a text of some pieces and the mark; one of fifty is very long."""
    pieces = [draw.choice(_PIECES) for _ in range(draw.randint(1, 6))]
    pieces.insert(draw.randint(0, len(pieces)), MARK)
    if draw.randrange(50) == 0:
        pieces.insert(draw.randint(0, len(pieces)), draw.choice(_PIECES) * _LONG)
    return "".join(pieces)


def hostile_name(draw: random.Random) -> str:
    """Draws a text that can be the name of a file."""
    text = re.sub(r"[/\0\ud800]", "_", hostile(draw))
    return text.encode()[:100].decode(errors="ignore")


_LINE_END = r"[\n\r\x0b\x0c\x1c-\x1e\x85\u2028\u2029]"  # whatever some reader takes as one
_C = (
    r'"(?:\\[^\n]|[^"\\\n])*"',
    r"'(?:\\[^\n]|[^'\\\n])+'",
    r"/\*.*?\*/",
    rf"//.*?(?={_LINE_END})",
)
_STRIPPED = {
    "matlab": (rf"%.*?(?={_LINE_END})", r"'[^'\n\r]*'", r'"[^"\n\r]*"'),
    "modelica": (
        r'"(?:\\.|[^"\\])*"',
        r"'(?:\\.|[^'\\])*'",
        r"/\*.*?\*/",
        rf"//.*?(?={_LINE_END})",
    ),
    "c": _C,
    "javascript": (*_C[:2], r"`(?:\\.|[^`\\])*`", *_C[2:]),
}
_TOKENS = {name: re.compile("|".join(each), re.DOTALL) for name, each in _STRIPPED.items()}


def code(language: str, text: str) -> str:
    """Returns a program without its strings and comments."""
    return _TOKENS[language].sub(" ", text + "\n")


def is_outside(language: str, text: str) -> bool:
    """Whether the mark stands in a program outside of strings and comments."""
    return MARK in code(language, text)


def names_in_xml(text: str) -> set[tuple[str, str]]:
    """Elements, and their attributes; raises XMLSyntaxError for text that is not XML."""
    parser = etree.XMLParser(resolve_entities=False, no_network=True)
    root: Any = etree.fromstring(text.encode(), parser)
    found = set()
    for each in root.getroottree().getroot().iter():
        if each.tag is etree.Comment:
            continue
        tag = each.tag if isinstance(each.tag, str) else repr(each.tag)
        found |= {(tag, ""), *((tag, str(name)) for name in each.attrib)}
    return found


class Page(HTMLParser):
    """Elements and attributes of a page, and the texts of its scripts."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.names: set[tuple[str, str]] = set()
        self.addresses: list[str] = []
        self.scripts: list[str] = []
        self._in_script = False
        self.feed(text)
        self.close()

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.names |= {(tag, ""), *((tag, name) for name, _ in attrs)}
        self.addresses += [value or "" for name, value in attrs if name in ("href", "src")]
        self._in_script = tag == "script"
        if self._in_script:
            self.scripts.append("")

    def handle_endtag(self, tag: str) -> None:
        self._in_script = False

    def handle_data(self, data: str) -> None:
        if self._in_script:
            self.scripts[-1] += data

    def handle_decl(self, decl: str) -> None:
        self.names.add(("!", decl))

    def handle_pi(self, data: str) -> None:
        self.names.add(("?", data))


def leaves(document: Any, above: tuple[Any, ...] = ()) -> Iterator[tuple[Any, ...]]:
    """Yields the places of all values in JSON; of a list, only those of its first and last item."""
    if isinstance(document, dict):
        for key, value in document.items():
            yield from leaves(value, (*above, key))
    elif isinstance(document, list):
        for i in sorted({0, len(document) - 1}) if document else ():
            yield from leaves(document[i], (*above, i))
    else:
        yield above


def forge(document: Any, draw: random.Random, text: Callable[[random.Random], str]) -> None:
    """Puts hostile texts into JSON: at places of texts, and sometimes of numbers and of keys."""
    every = list(leaves(document))
    texts = [place for place in every if isinstance(_at(document, place), str)]
    for _ in range(draw.randint(1, 3)):
        *above, last = draw.choice(texts if draw.random() < 0.8 else every)
        parent = _at(document, above)
        if isinstance(parent, dict) and draw.random() < 0.1:
            parent[text(draw)] = parent.pop(last, None)
        else:
            parent[last] = text(draw)


def _at(document: Any, place: Any) -> Any:
    for key in place:
        document = document[key]
    return document
