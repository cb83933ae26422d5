"""Splits and combines configurations of several joints, in which common values stand only once.

docs/log-reference.md has an example. A configuration of one joint has no section [joints], and the
name of the joint is "".
"""

import re
from collections.abc import Iterator, Mapping, MutableMapping
from typing import Any

import tomlkit
from tomlkit.container import Container
from tomlkit.items import Item, Table

from sigmahat.files import toml_file
from sigmahat.fmi.quoted import quoted

JOINTS = "joints"  # name of the section
Place = tuple[str, ...]
"""Sections and key of a TOML value: ("ports", "q", "unit"), ("parameters", "motor.B")."""
NAMES = "letters, digits, '_', '-' and '.', of which the last two are not first"
_LONGEST = 80  # characters of a name


def is_name(name: str) -> bool:
    """Returns whether a joint may have this name, which is also the name of a folder."""
    return len(name) <= _LONGEST and re.fullmatch(r"\w[\w.-]*", name) is not None


def names(document: Mapping[str, Any]) -> list[str]:
    """Returns the names of the joints in a document, [""] for a configuration of one joint.

    Raises ValueError for a name of a joint that is not allowed as the name of a folder.
    """
    joints = document.get(JOINTS)
    if not isinstance(joints, Mapping) or not joints:
        return [""]
    for name, each in joints.items():
        if not is_name(name):
            raise ValueError(f"[joints] has the name {quoted(name)}; expected {NAMES}")
        if not isinstance(each, Mapping):
            got = quoted(each)
            raise ValueError(f"joints.{name}: expected a table [joints.{name}], got {got}")
    return list(joints)


def of_joint(document: tomlkit.TOMLDocument, name: str) -> tomlkit.TOMLDocument:
    """Copies the configuration of one joint, with comments, from the document of all joints."""
    own = tomlkit.parse(tomlkit.dumps(document))
    if name:
        of_the_joint = items(own, name)
        del own[JOINTS]
        for place, item in of_the_joint.items():
            set_item(own, place, item)
    return own


def together(joints: Mapping[str, tomlkit.TOMLDocument], fill_in: str) -> tomlkit.TOMLDocument:
    """Combines the configurations of several joints; common values stand once in the document.

    Comments on separate lines are taken from the configuration of the first joint.

    fill_in  word in comments on values that the user has to fill in: those of ports and motors are
             not common, because joints have gears, encoders and motors of their own
    """
    first = next(iter(joints.values()))
    values = [items(each) for each in joints.values()]
    shared = {
        place
        for place, item in values[0].items()
        if all(place in each and each[place] == item for each in values[1:])
        and all(each[place].trivia.comment == item.trivia.comment for each in values[1:])
        and not (_is_of_hardware(place) and fill_in in item.trivia.comment)
    }
    document = tomlkit.parse(tomlkit.dumps(first))
    for place in values[0].keys() - shared:
        remove(document, place)
    if not document.get("temperature", True):  # which another joint need not have
        del document["temperature"]
    sections = tomlkit.table(is_super_table=True)
    for name, own in zip(joints, values, strict=True):
        section = tomlkit.table(is_super_table=True)
        for place, item in own.items():
            if place not in shared:
                set_item(section, place, item)
        sections[name] = section
    document[JOINTS] = sections
    return document


def _is_of_hardware(place: Place) -> bool:
    return place[0] == "ports" or place[-1].startswith("motor.")


def section(document: tomlkit.TOMLDocument, name: str) -> MutableMapping[str, Any]:
    """Returns the section of a joint in a document; for the joint "" the whole document."""
    found: MutableMapping[str, Any] = document
    return found[JOINTS][name] if name else found


def items(document: tomlkit.TOMLDocument, joint: str = "") -> dict[Place, Item]:
    """Returns every TOML value with its comment, in the order of the document.

    joint  only values in the section of this joint, with places relative to the section
    """
    every = dict(_items(document, ()))
    if not joint:
        return every
    above = (JOINTS, joint)
    return {place[2:]: item for place, item in every.items() if place[:2] == above}


def _items(container: Container, above: Place) -> Iterator[tuple[Place, Item]]:
    # The method container.items() would return true and false without their comments.
    for key, item in container.body:
        if key is None:
            continue
        if not isinstance(item, Table):
            yield (*above, key.key), item
        elif above[-1:] == ("parameters",):
            for (last,), value in _items(item.value, ()):
                yield (*above, f"{key.key}.{last}"), value
        else:
            yield from _items(item.value, (*above, key.key))


def set_item(document: MutableMapping[str, Any], place: Place, item: Item) -> None:
    """Sets a value in a TOML document, and creates missing sections around the value."""
    *above, name = place
    table: Any = document
    for depth, each in enumerate(above):
        # A TOML table that contains only tables needs no header.
        is_super = len(above) > depth + 1
        if each not in table:
            table[each] = tomlkit.table(is_super_table=is_super)
        table = table[each]
    toml_file.set_dotted(table, name, item)


def remove(document: MutableMapping[str, Any], place: Place) -> None:
    """Removes a value from a TOML document, and the dotted group if the group becomes empty."""
    *above, name = place
    table: Any = document
    for each in above:
        table = table[each]
    group, _, last = name.partition(".")
    if name in table:
        del table[name]
    else:
        del table[group][last]
        if not table[group]:
            del table[group]
