"""The table of findings: what the checks of a log found, `findings.json` in the folder of results.

Whoever checks a log writes the file; a folder without it has a report without the table.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from sigmahat.files.output import write_json
from sigmahat.joint.stored import NO_OTHER_KEYS, Format, Text
from sigmahat.report.contents import TextTable


@dataclass(frozen=True)
class ShownFinding:
    """A finding as it is shown."""

    __pydantic_config__ = NO_OTHER_KEYS

    severity: Text
    """How much it matters: "wrong", "rests on", "note"."""
    text: Text
    """A sentence: the key of the configuration, the number, and a value that is proposed."""


@dataclass(frozen=True)
class FindingsFile:
    """The contents of the file."""

    __pydantic_config__ = NO_OTHER_KEYS

    format: Text
    version: int
    findings: list[ShownFinding]


FINDINGS = Format("findings.json", "sigmahat findings", 1, FindingsFile)
"""Of the file."""


def write_findings(findings: Sequence[ShownFinding], folder: Path) -> None:
    """Writes the file into a folder of results; an empty list says that nothing was found."""
    contents = FindingsFile(FINDINGS.name, FINDINGS.version, list(findings))
    write_json(asdict(contents), folder / FINDINGS.file)


def findings_table(folder: Path) -> list[TextTable]:
    """The table of the file in a folder; none if there is no file.

    Raises ValueError, which says what is wrong, for a damaged file.
    """
    if not (folder / FINDINGS.file).is_file():
        return []
    found = FINDINGS.read(folder).findings
    rows = [[each.severity, each.text] for each in found]
    note = "" if rows else "Nothing in the log contradicts the configuration."
    return [TextTable("Checks", ["", "finding"], rows, [True, True], note=note)]
