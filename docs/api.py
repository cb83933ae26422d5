"""The page of the Python API, from its docstrings: `cmake --build build --target api`."""

import sys
from pathlib import Path

import pdoc

import sigmahat

# Excluded are modules that are no API, though their classes may be part of it.
MODULES = ("sigmahat", "sigmahat.plants.plant", "sigmahat.plants.fmu")


def main(folder: Path) -> None:
    """Write index.html and what it links to into a folder."""
    for name in sigmahat.__all__:  # pdoc sees what is imported already
        setattr(sigmahat, name, getattr(sigmahat, name))
    pdoc.render.configure(docformat="markdown", show_source=False, search=False)
    pdoc.pdoc("sigmahat", r"!sigmahat\.", *MODULES[1:], output_directory=folder)


if __name__ == "__main__":
    main(Path(sys.argv[1]))
