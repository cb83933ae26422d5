"""Interprets the name of a column: quantity, side of the joint, unit, and name of the joint."""

import re
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import tomlkit

_ORDER = (
    "other",
    "temperature",
    "acceleration",
    "velocity",
    "position",
    "current",
    "torque",
    "time",
    "index",
)
"""Quantities by priority: the first one counts in a name with several, as "current position"."""
_UNIT_OF = {
    **dict.fromkeys(("rad", "mrad", "deg", "turn", "arcmin", "arcsec"), "position"),
    **dict.fromkeys(("N.m", "mN.m", "kN.m", "N.cm"), "torque"),
    **dict.fromkeys(("A", "mA"), "current"),
    **dict.fromkeys(("s", "ms", "us", "ns"), "time"),
}
_INSIDE, _AT_AN_END, _PART = 5, 4, 3  # least numbers of letters of a word in a longer word
_LETTERS = str.maketrans({"ß": "ss", "°": "deg", "µ": "u", "μ": "u", "θ": "theta", "τ": "tau"})
_BRACKET = re.compile(r"[\[({<]([^\[\](){}<>]*)[\])}>]\s*$")
_NUMBER_TYPE = re.compile(r"(?<=[_. ])(?:[ui](?:12|14|16|24|32)|u?int\d+|float\d+)(?:_t)?$")
"""Type of a number at the end of a name, as in "angle_u16"."""
_JOINT_STATE = re.compile(r"\.(position|velocity|effort)\[[^\[\]]*[^\d\[\]][^\[\]]*\]$")
"""Columns of a sensor_msgs/JointState, as readers/bags.py names them."""
_TOKEN = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+|\d+")


@dataclass(frozen=True)
class Meaning:
    """Meaning of the name of a column. A field is None if the name contains no such word."""

    quantity: str | None
    """time, index, position, deformation, velocity, acceleration, torque, current, temperature, or
    other."""
    side: str | None  # motor, link, setting (what sets the stiffness), or sensor (of the torque)
    suggested: str | None  # motor or link, from a word that only suggests this side
    unit: str | None  # unit, as in configurations
    speed: str | None  # unit of a velocity: rad for rad/s, or turn/min
    reference: bool  # whether the signal is a reference, not a measurement
    computed: bool  # whether the signal is an estimate, or the truth of a simulation
    effort: bool  # whether a torque is called effort, as in ROS
    message: bool  # whether the signal is of a JointState of ROS, in rad and N.m
    joints: tuple[str, ...]  # words that are names of joints
    rest: tuple[str, ...]  # unknown words and numbers, and words that are names of joints


_Entry = Mapping[str, str]  # meanings of a word in the vocabulary, by section


def meaning(name: str) -> Meaning:
    unit, tokens = _without_unit(name)
    entries: list[_Entry] = []
    rest: list[str] = []
    joints: list[str] = []
    before = ""
    for text, entry in _entries(tokens):
        if entry is None or "joint" in entry:
            letter = text.isdigit() and bool(rest) and rest[-1] == before and len(before) == 1
            if letter:  # a1, of a1_motor
                rest[-1] += text
            else:
                rest.append(text)
            joints += [text] if entry else []
        before = text
        if entry is not None:
            entries.append(entry)
    roles = {role for entry in entries if (role := entry.get("role"))}
    quantity = _quantity(entries)
    if _is_time(re.split(r"[./]", name)[-1]):
        quantity = "time"
    if unit.foreign is not None:
        quantity = unit.foreign
    elif quantity not in ("other", "temperature", "velocity", "acceleration"):
        quantity = _UNIT_OF.get(unit.name or "", quantity)
    side = _first("side", ("sensor", "setting", "motor", "link"), entries)
    if "deformation" in roles:
        if quantity in (None, "position") and unit.name != "mm":
            quantity = "deformation"
        elif quantity == "torque" and side is None:
            side = "sensor"
    suggested = _first("suggests", ("motor", "link"), entries)
    is_message = "message" in roles or _JOINT_STATE.search(name) is not None
    said = "reference" in roles, "computed" in roles, "effort" in roles, is_message
    return Meaning(
        quantity, side, suggested, unit.name, unit.speed, *said, tuple(joints), tuple(rest)
    )


def _is_time(part: str) -> bool:
    """Returns whether the last part of a path names a time, as in "/current.time"."""
    entry = _vocabulary().entries.get(_plain(part).lower())
    return entry is not None and entry.get("quantity") == "time" and "symbol" not in entry


def _quantity(entries: Sequence[_Entry]) -> str | None:
    """Returns the quantity that a name mentions by a word, else by a symbol."""
    words = [entry for entry in entries if "symbol" not in entry]
    return _first("quantity", _ORDER, words) or _first("quantity", _ORDER, entries)


def _first(section: str, order: Sequence[str], entries: Sequence[_Entry]) -> str | None:
    found = {entry.get(section) for entry in entries}
    return next((each for each in order if each in found), None)


def _plain(text: str) -> str:
    """Replaces accents and symbols of a text by plain letters; upper case is kept."""
    written = _vocabulary().written
    # "ュ" and other parts of letters are composed, as they are in the words.
    text = unicodedata.normalize("NFKC", text.translate(_LETTERS))
    if not text.isascii():
        for word in sorted(written, key=len, reverse=True):
            text = text.replace(word, f" {written[word]} ")
    decomposed = unicodedata.normalize("NFKD", text)
    return "".join(each for each in decomposed if not unicodedata.combining(each))


@dataclass(frozen=True)
class _Unit:
    """The unit in a name; all fields are None for a name without a unit."""

    name: str | None = None  # a unit of a port
    foreign: str | None = None  # the quantity, for a unit that no port has
    speed: str | None = None


def _without_unit(name: str) -> tuple[_Unit, list[str]]:
    """Splits a name into the unit at its end and the other words."""
    text, units = _NUMBER_TYPE.sub("", _plain(name)), _vocabulary().units
    bracket = _BRACKET.search(text)
    if bracket:
        unit = units.get(re.sub(r"[\s.*·⋅]|\bin\b", "", bracket[1]).lower())
        if unit is not None:
            return unit, _TOKEN.findall(text[: bracket.start()])
    tokens = _TOKEN.findall(text)
    for count in (3, 2, 1):
        last = [token.lower() for token in tokens[-count:]]
        if len(last) < count:
            continue
        unit = units.get("/".join(each for each in last if each != "per"))
        unit = unit or units.get("".join(last))
        if unit is not None and _is_unit(tokens, count, unit):
            return unit, tokens[:-count]
    return _Unit(), tokens


def _is_unit(tokens: Sequence[str], count: int, unit: _Unit) -> bool:
    """Returns whether the last words are a unit; a single letter must fit the other words."""
    if count > 1 or len(tokens[-1]) > 1:
        return len(tokens) > count or len(tokens[-1]) > 2
    before = _quantity([entry for _, entry in _entries(tokens[:-1]) if entry is not None])
    of = _UNIT_OF.get(unit.name or "")
    fits = of == before or (of, before) == ("current", "torque")
    return of is not None and (fits or (before is None and tokens[-1] == "A" and len(tokens) > 1))


def _entries(tokens: Sequence[str]) -> Iterator[tuple[str, _Entry | None]]:
    """Yields words with their entries in the vocabulary, None for unknown words."""
    entries = _vocabulary().entries
    words = [token.lower() for token in tokens]
    i = 0
    while i < len(words):
        for count in (3, 2, 1):
            text = " ".join(words[i : i + count])
            if i + count <= len(words) and text in entries:
                yield text, entries[text]
                i += count
                break
        else:
            for part in _parts(words[i]):
                yield part, entries.get(part)
            i += 1


@cache
def _parts(word: str) -> tuple[str, ...]:
    """Splits a long word into known words and the remaining parts."""
    entries = _vocabulary().entries
    if word in entries or word.isdigit():
        return (word,)
    for cut in range(_PART, len(word) - _PART + 1):
        if word[:cut] in entries and word[cut:] in entries:
            return word[:cut], word[cut:]
    for known in _vocabulary().longest_first:
        at = word.find(known)
        ends = at == 0 or (at > 0 and word.endswith(known))
        if at >= 0 and (len(known) >= _INSIDE or ends):
            at = at if len(known) >= _INSIDE or at == 0 else len(word) - len(known)
            sides = (word[:at], word[at + len(known) :])
            left, right = (_parts(side) if len(side) >= _PART else () for side in sides)
            return (*left, known, *right)
    return (word,)


@dataclass(frozen=True)
class _Vocabulary:
    """The contents of vocabulary.toml, by words."""

    entries: Mapping[str, _Entry]
    units: Mapping[str, _Unit]
    longest_first: Sequence[str]
    written: Mapping[str, str]  # words in other scripts, and what they mean


@cache
def _vocabulary() -> _Vocabulary:
    text = Path(__file__).with_name("vocabulary.toml").read_text(encoding="utf-8")
    table: dict[str, Any] = tomlkit.parse(text).unwrap()
    entries: dict[str, dict[str, str]] = {}
    for section in ("quantity", "side", "suggests", "role", "symbol", "joint", "neutral"):
        for kind, words in table[section].items():
            for word in words:
                entries.setdefault(word, {}).setdefault(section, kind)
    known = [word for word in entries if len(word) >= _AT_AN_END and " " not in word]
    units = {word: _Unit(name) for name, words in table["unit"].items() for word in words}
    for speed, words in table["speed"].items():
        units |= dict.fromkeys(words, _Unit(foreign="velocity", speed=speed))
    for quantity, words in table["foreign"].items():
        units |= dict.fromkeys(words, _Unit(foreign=quantity))
    written = {word: meant for meant, words in table["written"].items() for word in words}
    return _Vocabulary(entries, units, sorted(known, key=len)[::-1], written)
