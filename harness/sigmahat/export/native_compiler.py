"""The binary of an FMU for this machine, by the C compiler that is installed here."""

from __future__ import annotations

import os
import shlex
import shutil
import subprocess
from pathlib import Path

import fmpy

from sigmahat.export.cross_compiler import FLAGS


def compile_folder(sources: Path, binary: Path) -> None:
    """Compiles every C file of a folder into a shared library.

    Raises RuntimeError if there is no compiler (gcc or clang, or the one that CC names), or if it
    refuses.
    """
    compiler = os.environ.get("CC") or next(filter(shutil.which, ("cc", "gcc", "clang")), None)
    if compiler is None:
        raise RuntimeError("no C compiler found: install gcc or clang, or name one in CC")
    files = sorted(file.name for file in sources.glob("*.c"))
    include = f"-I{Path(fmpy.__file__).parent / 'c-code'}"
    try:
        done = subprocess.run(
            [*shlex.split(compiler), *FLAGS, include, *files, "-lm", "-o", str(binary.resolve())],
            cwd=sources,
            capture_output=True,
            text=True,
        )
    except OSError as error:
        raise RuntimeError(f"CC={compiler}: {error.strerror}") from error
    if done.returncode:
        raise RuntimeError(f"{compiler} could not compile the plant:\n{done.stderr}")
