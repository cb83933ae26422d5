r"""Puts texts into generated files: one function for each language, for strings or comments.

A text may come from a stranger's file, so that it may contain anything. Each function returns one
line. Characters that no reader shows, line ends of all kinds among them, are written as \u2028.
HTML, and elements and attributes of XML, are escaped by Jinja2, see templates.py.
"""

import re


def one_line(text: str) -> str:
    """Writes all characters that do not print as \\uXXXX or \\UXXXXXXXX."""
    return "".join(c if c.isprintable() else _code(c) for c in text)


def _code(c: str) -> str:
    if "\ud800" <= c <= "\udfff":  # half of a character, which no file may contain
        return "\N{REPLACEMENT CHARACTER}"
    return f"\\u{ord(c):04x}" if ord(c) < 1 << 16 else f"\\U{ord(c):08x}"


def xml_comment(text: str) -> str:
    """Returns a comment of XML, in which no two hyphens are neighbours."""
    return f"<!-- {re.sub('-(?=-)', '- ', one_line(text))} -->"


def matlab_comment(text: str) -> str:
    """Returns a comment of MATLAB up to the end of its line; a block would begin with %{."""
    return f"% {one_line(text)}"


def modelica_comment(text: str) -> str:
    """Returns a comment of Modelica up to the end of its line."""
    return f"// {one_line(text)}"


def modelica_string(text: str) -> str:
    """Returns a string of Modelica with its quotes."""
    return f'"{_without_quotes(one_line(text))}"'


def c_string(text: str) -> str:
    """Returns a string of C99 with its quotes; the text has no characters that do not print."""
    escaped = _without_quotes(one_line(text)).replace("?", "\\?")  # no trigraphs
    return f'"{escaped}"'


def _without_quotes(text: str) -> str:
    return text.replace("\\", "\\\\").replace('"', '\\"')


def yaml_string(text: str) -> str:
    """Returns a string of YAML with its quotes, which a reader takes as the same text."""
    kept = (_without_quotes(c) if c.isprintable() else _code(c) for c in text)
    return f'"{"".join(kept)}"'
