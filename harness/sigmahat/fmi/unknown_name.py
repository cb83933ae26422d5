"""The error message for a name that does not exist."""

from collections.abc import Iterable
from difflib import get_close_matches

from sigmahat.fmi.quoted import cut, quoted

_LONGEST = 200  # characters of a name for which similar names are looked for
_MOST_LISTED = (
    150  # names that exist; the estimator has 100 parameters, a log can have more columns
)

_RENAMED = {
    "MatchedFilter": "FilteredRegression",
    "confidence": "limit.relative_std",
    "matched.bandwidth": "regression.bandwidth",
    "matched.drift": "regression.drift",
    "matched.memory": "regression.memory",
    "matched.slow": "regression.slow",
}


def unknown(kind: str, name: str, existing: Iterable[str]) -> str:
    """Returns one line with the unknown name, and similar, existing or new names.

    A list of more than 20 existing names is left out if a similar name was found.

    kind  what the name stands for, as in "unknown scenario 'tabel1'"
    """
    names = sorted(existing)
    if _RENAMED.get(name) in names:
        return f"unknown {kind} {name!r}: it is called {_RENAMED[name]!r} now"
    short = len(name) <= _LONGEST
    similar = get_close_matches(name, names, n=3, cutoff=0.6) if short else []
    message = f"unknown {kind} {quoted(name)}"
    if similar:
        message += "; did you mean " + " or ".join(map(quoted, similar)) + "?"
    if not similar or len(names) <= 20:
        listed = ", ".join(map(cut, names[:_MOST_LISTED])) or "none"
        more = len(names) - _MOST_LISTED
        message += f" (there are: {listed}{f', and {more} more' if more > 0 else ''})"
    return message
