"""The page of the Python API, from its docstrings: `cmake --build build --target api`."""

from __future__ import annotations

import sys
from pathlib import Path

import pdoc

import sigmahat


def write(page: Path) -> None:
    """Writes the page, one HTML file; its folder is made."""
    for name in sigmahat.__all__:  # they are imported when they are used, which pdoc does not do
        setattr(sigmahat, name, getattr(sigmahat, name))
    module = pdoc.doc.Module(sigmahat)
    pdoc.render.configure(docformat="markdown", show_source=False, search=False)
    html = pdoc.render.html_module(module, all_modules={"sigmahat": module})
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(html, encoding="utf-8")


if __name__ == "__main__":
    write(Path(sys.argv[1]))
    print(sys.argv[1])
