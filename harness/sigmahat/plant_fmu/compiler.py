"""Compiles the binary of an FMU with the compiler of this machine."""

import os
import shlex
import shutil
import subprocess
from pathlib import Path

import fmpy

# Without fused operations (contraction), all machines compute the same numbers. Symbols and
# debug information would contain paths (-s removes both).
CODE = ("-std=c99", "-O2", "-ffp-contract=off", "-fvisibility=hidden", "-s")
FLAGS = (*CODE, "-fPIC", "-shared")

HEADERS = Path(fmpy.__file__).parent / "c-code"
"""Folder of the header files of FMI."""


def compile_folder(sources: Path, binary: Path) -> None:
    """Compiles every C file of a folder into a shared library.

    Raises RuntimeError if no compiler is found (gcc or clang, or the compiler in CC), or if the
    compiler fails.
    """
    compiler = os.environ.get("CC") or next(filter(shutil.which, ("cc", "gcc", "clang")), None)
    if compiler is None:
        raise RuntimeError("no C compiler found: install gcc or clang, or name one in CC")
    files = sorted(file.name for file in sources.glob("*.c"))
    arguments = [*FLAGS, f"-I{HEADERS}", *files, "-lm", "-o", str(binary.resolve())]
    try:
        command = [*shlex.split(compiler), *arguments]
        completed = subprocess.run(command, cwd=sources, capture_output=True, text=True)
    except OSError as error:
        raise RuntimeError(f"CC={compiler}: {error.strerror}") from error
    if completed.returncode:
        raise RuntimeError(f"{compiler} could not compile the plant:\n{completed.stderr}")
