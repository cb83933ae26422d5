"""The page of the Python API, from its docstrings: `cmake --build build --target api`."""

from __future__ import annotations

import dataclasses
import inspect
import sys
from pathlib import Path
from typing import get_type_hints

import pdoc

import sigmahat


def write(page: Path) -> None:
    """Writes the page, one HTML file; its folder is made."""
    for name in sigmahat.__all__:
        each = getattr(sigmahat, name)
        setattr(sigmahat, name, each)  # for pdoc: it does not import lazily
        if inspect.isclass(each) and dataclasses.is_dataclass(each):
            _without_checks(each)
    module = pdoc.doc.Module(sigmahat)
    pdoc.render.configure(docformat="markdown", show_source=False, search=False)
    html = pdoc.render.html_module(module, all_modules={"sigmahat": module})
    page.parent.mkdir(parents=True, exist_ok=True)
    page.write_text(html, encoding="utf-8")


def _without_checks(data: type) -> None:
    """Leaves the types of fields alone: a check that comes with them is no text for a page."""
    for annotated in (data, vars(data)["__init__"]):
        annotated.__annotations__ = get_type_hints(annotated)


if __name__ == "__main__":
    write(Path(sys.argv[1]))
    print(sys.argv[1])
