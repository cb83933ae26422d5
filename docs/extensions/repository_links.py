"""Links to Markdown files outside of docs/, as they work on GitHub, work on the site, too.

The changelog and the like are pages of the site that include the file: a link leads to the page.
"""

from pathlib import Path

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

PAGES = {
    **{"CHANGELOG": "changelog", "CONTRIBUTING": "contributing"},
    **{"README": "index", "SECURITY": "security"},
}
"""Page of the site by file of the repository, without suffix."""


def _resolve(app: Sphinx, document: nodes.document) -> None:
    docs = Path(app.srcdir)
    for link in document.findall(addnodes.pending_xref):
        if link["reftype"] != "myst":
            continue
        # Without a domain it is in a page that includes a file of the repository.
        folder = docs if link["refdomain"] == "doc" else docs.parent
        target = (folder / link["reftarget"]).resolve()
        if target.parent == docs.parent and target.stem in PAGES:
            link["refdomain"], link["reftarget"] = "doc", PAGES[target.stem]
            link.attributes.setdefault("reftargetid", None)


def setup(app: Sphinx) -> dict[str, bool]:
    """Links are looked at when a page was read."""
    app.connect("doctree-read", _resolve)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
