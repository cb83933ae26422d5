"""The values that a parameter takes in a sweep, as written on the command line or in a plan.

0.9e-3,1.1e-3          each of a list; names of items and true, false too
0.8e-3:1.2e-3:9        9 values at equal distances, both ends among them
uniform(0.9e-3,1.1e-3) drawn for each seed, between two ends
normal(1e-3,5e-5)      drawn for each seed, by mean and standard deviation
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any
from zlib import crc32

import numpy as np

from sigmahat.fmi.instance import Value

_CALL = re.compile(r"\s*(\w+)\s*\(([^()]*)\)\s*")
_FORMS = "values 1,2,3; a range first:last:count; uniform(low,high); normal(mean,deviation)"


@dataclass(frozen=True)
class Drawn:
    """A value that depends on the seed of the run alone."""

    kind: str
    """uniform or normal."""
    first: float
    """Lower end, or mean."""
    second: float
    """Upper end, or standard deviation."""

    def value(self, name: str, seed: int) -> float:
        """Value of the parameter of this name under a seed; independent for every name."""
        generator = np.random.default_rng([seed, crc32(name.encode())])
        draw = generator.uniform if self.kind == "uniform" else generator.normal
        return float(draw(self.first, self.second))


Values = tuple[Value, ...] | Drawn


def values(text: Any) -> Values:
    """Reads what stands behind a name: text as above, or a value or list of values of a plan.

    Raises ValueError, which says what is expected.
    """
    if isinstance(text, Sequence) and not isinstance(text, str):
        if not text or not all(isinstance(v, (float, int, str)) for v in text):
            raise ValueError(f"expected {_FORMS}, got {text!r}")
        return _distinct([v if not isinstance(v, str) else _literal(v) for v in text])
    if not isinstance(text, str):
        return values([text])
    call = _CALL.fullmatch(text)
    if call is not None:
        return _drawn(text, call[1], call[2].split(","))
    if text.count(":") == 2:
        return _range(text)
    if any(not part.strip() for part in text.split(",")) or "(" in text:
        raise ValueError(f"expected {_FORMS}, got {text!r}")
    return values(text.split(","))


def _distinct(items: Sequence[Value]) -> tuple[Value, ...]:
    item, count = Counter(items).most_common(1)[0]
    if count > 1:
        raise ValueError(f"{item!r} is given twice")
    return tuple(items)


def _drawn(text: str, kind: str, arguments: Sequence[str]) -> Drawn:
    try:
        first, second = map(_finite, arguments)
    except ValueError:
        first = second = math.nan
    fits = {"uniform": first < second, "normal": second > 0.0}
    if not fits.get(kind, False):
        raise ValueError(f"expected {_FORMS}, got {text!r}")
    return Drawn(kind, first, second)


def _range(text: str) -> tuple[Value, ...]:
    first, last, count = text.split(":")
    try:
        ends, number = (_finite(first), _finite(last)), int(count)
    except ValueError as error:
        raise ValueError(f"expected {_FORMS}, got {text!r}") from error
    if not 2 <= number <= 1_000_000 or ends[0] == ends[1]:
        raise ValueError(f"expected a range of 2 or more different values, got {text!r}")
    return tuple(np.linspace(*ends, number).tolist())


def _literal(text: str) -> Value:
    text = text.strip()
    if text in ("true", "false"):
        return text == "true"
    for kind in (int, _finite):
        try:
            return kind(text)
        except ValueError:
            continue
    return text


def _finite(text: str) -> float:
    value = float(text)
    if not math.isfinite(value):
        raise ValueError(text)
    return value
