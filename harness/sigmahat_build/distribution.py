"""Writes the files for pip: a wheel for each platform, and the source distribution."""

import os
import shutil
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path
from tempfile import TemporaryDirectory

from sigmahat_build.cross_compiler import PLATFORMS, compile_shared

TAGS = {
    "linux64": "manylinux_2_17_x86_64",
    "win64": "win_amd64",
    "darwin64": "macosx_11_0_x86_64",
}
"""Platform tags of pip, with the system versions of the targets of the cross compiler."""

# The FMUs and the library are already built, so CMake is not run.
_HOOK = (
    "import sys; from scikit_build_core import build; "
    "getattr(build, sys.argv[1])(sys.argv[2], {'wheel.cmake': 'false'})"
)
_EPOCH = "315532800"  # 1980, the first year of a zip file: equal contents are equal bytes


def write(
    out: Path,
    project: Path,
    contents: Iterable[Path],
    sources: Iterable[Path],
    includes: Iterable[Path],
    cache: Path,
) -> None:
    """Write all wheels and the source distribution into a folder, which is emptied before.

    project    folder of pyproject.toml
    contents   released FMUs and systems
    sources    C files of the library of the package; includes: folders of their headers
    cache      as for ``compile_shared``

    Raises ``subprocess.CalledProcessError`` if a tool fails; the tool prints why on stderr.
    """
    shutil.rmtree(out, ignore_errors=True)
    out.mkdir(parents=True)
    _python(project, "-c", _HOOK, "build_sdist", out.resolve())
    with TemporaryDirectory() as scratch:
        pure, unpacked = Path(scratch, "pure"), Path(scratch, "unpacked")
        pure.mkdir()
        _python(project, "-c", _HOOK, "build_wheel", pure)
        (wheel,) = pure.glob("*.whl")
        _python(project, "-m", "wheel", "unpack", wheel, "--dest", unpacked)
        (tree,) = unpacked.iterdir()
        (kind,) = tree.glob("*.dist-info/WHEEL")
        text = kind.read_text(encoding="utf-8").replace("Purelib: true", "Purelib: false")
        kind.write_text(text, encoding="utf-8")
        folder = tree / "sigmahat" / "fmus"
        folder.mkdir()
        for file in contents:
            shutil.copy(file, folder)
        for platform in PLATFORMS:
            stem = folder / "sigmahat_native"
            library = compile_shared(sources, includes, stem, platform, cache)
            _python(project, "-m", "wheel", "pack", tree, "--dest-dir", scratch)
            (packed,) = Path(scratch).glob("*.whl")
            tag = ("--platform-tag", TAGS[platform])
            _python(project, "-m", "wheel", "tags", "--remove", *tag, packed)
            (tagged,) = Path(scratch).glob("*.whl")
            shutil.move(tagged, out)
            library.unlink()


def _python(project: Path, *arguments: str | Path) -> None:
    command = [sys.executable, *arguments]
    environment = {**os.environ, "SOURCE_DATE_EPOCH": _EPOCH}
    subprocess.run(command, cwd=project, env=environment, check=True, stdout=subprocess.DEVNULL)
