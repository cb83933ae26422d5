"""Compiles the binaries of an FMU for all platforms, on any of these platforms."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import fmpy

from sigmahat.plant_fmu import archive
from sigmahat.plant_fmu.compiler import FLAGS, HEADERS

PLATFORMS = {
    "linux64": ("x86_64-linux-gnu.2.17", ".so"),
    "win64": ("x86_64-windows-gnu", ".dll"),
    "darwin64": ("x86_64-macos.11.0", ".dylib"),
}
"""Platforms of FMI 2.0: target of the compiler, extension of a shared library."""

PLATFORMS_3 = {
    "x86_64-linux": PLATFORMS["linux64"],
    "x86_64-windows": PLATFORMS["win64"],
    "x86_64-darwin": PLATFORMS["darwin64"],
    "aarch64-linux": ("aarch64-linux-gnu.2.17", ".so"),
    "aarch64-darwin": ("aarch64-macos.11.0", ".dylib"),
}
"""Platforms of FMI 3.0, which also has names for processors of the ARM family."""


def compile_files(target: str, arguments: Iterable[str | Path], cache: Path, cwd: Path) -> None:
    """Call the compiler for a target in a folder.

    ``cache`` is a folder for compiled parts that can be used again. Raises
    ``subprocess.CalledProcessError`` if the compiler fails; the compiler prints why on stderr.
    """
    folder = str(cache.resolve())
    caches = {"ZIG_GLOBAL_CACHE_DIR": folder, "ZIG_LOCAL_CACHE_DIR": folder}
    command = [sys.executable, "-m", "ziglang", "cc", "-target", target, *arguments]
    subprocess.run(command, cwd=cwd, env={**os.environ, **caches}, check=True)


def source_files(folder: Path) -> list[Path]:
    # FMPy reads the SourceFiles of FMI 2.0 as a build configuration of FMI 3.0.
    described: Any = fmpy.read_model_description(str(folder))
    listed = described.buildConfigurations[0].sourceFileSets[0].sourceFiles
    return [folder / "sources" / source for source in listed]


def compile_shared(
    sources: Iterable[Path], includes: Iterable[Path], out: Path, platform: str, cache: Path
) -> Path:
    """Compile C files to a shared library, and return its path: out with the usual extension.

    ``includes`` are folders of headers beside FMI's; ``cache`` and errors as ``compile_files``.
    """
    target, extension = {**PLATFORMS, **PLATFORMS_3}[platform]
    library = out.with_name(out.name + extension)
    with TemporaryDirectory() as scratch:
        arguments: list[str | Path] = [
            *FLAGS,
            *(f"-I{folder.resolve()}" for folder in (*includes, HEADERS)),
            *(source.resolve() for source in sources),
            # Without a folder: a library of macOS stores the name given to the linker.
            *("-lm", "-o", library.name),
        ]
        compile_files(target, arguments, cache, Path(scratch))
        library.parent.mkdir(parents=True, exist_ok=True)
        shutil.move(Path(scratch) / library.name, library)
    return library


def release(fmu: Path, out: Path, cache: Path) -> None:
    """Write a copy of an FMU with binaries for every platform instead of its own binaries.

    The sources in the FMU are compiled; ``cache`` and errors as ``compile_files``.
    """
    with TemporaryDirectory() as unpacked:
        folder = Path(fmpy.extract(str(fmu), unzipdir=unpacked))
        shutil.rmtree(folder / "binaries")
        described = fmpy.read_model_description(str(folder))
        for platform in PLATFORMS_3 if described.fmiVersion == "3.0" else PLATFORMS:
            binary = folder / "binaries" / platform / described.coSimulation.modelIdentifier
            compile_shared(source_files(folder), [folder / "sources"], binary, platform, cache)
        archive.write(out, archive.files_in(folder))
