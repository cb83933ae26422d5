"""What to say about a name that does not exist."""

from __future__ import annotations

from collections.abc import Iterable
from difflib import get_close_matches


def unknown(kind: str, name: str, known: Iterable[str]) -> str:
    """Returns one line that names what came, what was probably meant, and what there is.

    A long list is left out where a similar name was found.
    """
    names = sorted(known)
    similar = get_close_matches(name, names, n=3, cutoff=0.6)
    message = f"unknown {kind} {name!r}"
    if similar:
        message += "; did you mean " + " or ".join(map(repr, similar)) + "?"
    if not similar or len(names) <= 20:
        message += f" (there are: {', '.join(names) or 'none'})"
    return message
