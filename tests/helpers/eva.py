"""Frama-C Eva: which run-time errors are possible in C code, found by abstract interpretation."""

import re
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from controllers import run
from gate import need

OPTIONS = (
    *("-eva", "-machdep", "gcc_x86_64"),
    # Eva treats infinite numbers and NaN as normal values: no operation on them is an error.
    *("-warn-special-float", "none"),
    "-warn-invalid-pointer",  # computing a pointer outside of an object is an error, too
    *("-eva-domains", "cvalue", "-eva-slevel", "0"),
    "-eva-msg-key=-initial-state,-final-states",
)


@dataclass(frozen=True)
class Analysis:
    """What Eva found."""

    alarms: tuple[str, ...]
    """Possible errors, and assertions and preconditions that Eva could not prove: place and text.
    """
    proven: int  # assertions and preconditions
    coverage: int  # share of the statements that it reached in the functions that it analysed [%]
    text: str  # all that it printed


def analyse(
    sources: Sequence[Path],
    main: str,
    folders: Sequence[Path],
    *options: str,
    macros: Mapping[str, object],
    before: str | None = None,
) -> Analysis:
    """Analyses a program from `main` on.

    sources  all C files of the program
    folders  of its headers
    options  of Frama-C
    macros   for the preprocessor
    before   header that every file includes before all others

    Raises AssertionError if Frama-C stopped before the end of the analysis.
    """
    preprocessor = [
        *(f"-I{folder}" for folder in folders),
        *(f"-D{name}={value}" for name, value in macros.items()),
        *(() if before is None else ("-include", before)),
        "-U__SSE2__",  # vectors are no standard C: pair.h has the same in plain C
    ]
    command = [need("frama-c"), *OPTIONS, "-main", main]
    command += [f"-cpp-extra-args={' '.join(preprocessor)}", *options, *map(str, sources)]
    done = subprocess.run(command, capture_output=True, text=True)
    text = done.stdout + done.stderr
    alarms = re.findall(r"^\[eva:alarm\] (\S+?):(\d+): Warning:\s+(.*(?:\n {2,}.*)*)", text, re.M)
    coverage = re.search(r"statements reached \(out of \d+\): (\d+)% coverage", text)
    properties = re.findall(
        r"^ +(?:Assertions|Preconditions) +(\d+) valid +(\d+) unknown +(\d+) invalid", text, re.M
    )
    assert coverage is not None and properties, text
    unproven = sum(int(unknown) + int(invalid) for _, unknown, invalid in properties)
    assert unproven == 0 or alarms, text  # each of them is an alarm, too
    return Analysis(
        alarms=tuple(
            f"{Path(file).name}:{line}: {' '.join(found.split())}" for file, line, found in alarms
        ),
        proven=sum(int(valid) for valid, _, _ in properties),
        coverage=int(coverage.group(1)),
        text=text,
    )


def with_fault(source: Path, copy: Path, file: str, code: str, fault: str = "") -> Path:
    """Copies a folder of sources. In one file, the text `code` is replaced by `fault`."""
    shutil.copytree(source, copy)
    text = (copy / file).read_text()
    assert text.count(code) == 1
    (copy / file).write_text(text.replace(code, fault))
    return copy


def library_source(name: str) -> Path:
    """A source of the C library that comes with Frama-C."""
    return Path(run(need("frama-c"), "-print-share-path").strip()) / "libc" / name
