"""Links to Markdown files outside of docs/, as they work on GitHub, work on the site, too.

A page of the site includes the file, and has its name in small letters: a link leads to the page.
The README is the start page.
"""

from pathlib import Path

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx


def _resolve(app: Sphinx, document: nodes.document) -> None:
    docs = Path(app.srcdir)
    for link in document.findall(addnodes.pending_xref):
        if link["reftype"] != "myst":
            continue
        # Without a domain it is in a page that includes a file of the repository.
        folder = docs if link["refdomain"] == "doc" else docs.parent
        target = (folder / link["reftarget"]).resolve()
        page = "index" if target.stem == "README" else target.stem.lower()
        if target.parent == docs.parent and (docs / f"{page}.md").is_file():
            link["refdomain"], link["reftarget"] = "doc", page
            link.attributes.setdefault("reftargetid", None)


def setup(app: Sphinx) -> dict[str, bool]:
    """Links are looked at when a page was read."""
    app.connect("doctree-read", _resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
