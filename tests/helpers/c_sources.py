"""The C code of the library: where it is, and what a compiler needs to find its headers."""

from pathlib import Path

REPOSITORY = Path(__file__).resolve().parents[2]
LIBRARY = REPOSITORY / "c"
NATIVE = REPOSITORY / "harness" / "native"
SOURCES = sorted(LIBRARY.rglob("*.c"))
HEADERS = sorted(LIBRARY.rglob("*.h"))
FOLDERS = sorted({header.parent for header in HEADERS})


def generated(source: Path, build: Path) -> Path:
    """The folder of the generated code that a file includes, or that of a plant."""
    fmu = "StiffnessEstimator" if source.parent == NATIVE else source.stem
    own = build / "fmu" / fmu
    return own if own.is_dir() else build / "fmu" / "AwasPlant"
