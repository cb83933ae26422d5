"""Links to Markdown files outside of docs/, as they work on GitHub, work on the site, too.

The changelog and the like are pages of the site that include the file: a link leads to the page.
Any other file is a download, as MyST does it for all files that are not Markdown.
"""

import os.path
from pathlib import Path

from docutils import nodes
from sphinx import addnodes
from sphinx.application import Sphinx

PAGES = {"CHANGELOG": "changelog", "CONTRIBUTING": "contributing", "README": "index"}
"""Page of the site by file of the repository, without suffix."""


def _resolve(app: Sphinx, document: nodes.document) -> None:
    docs = Path(app.srcdir)
    for link in list(document.findall(addnodes.pending_xref)):
        if link["reftype"] != "myst":
            continue
        # Without a domain it is in a page that includes a file of the repository.
        known = link["refdomain"] == "doc"
        target = ((docs if known else docs.parent) / link["reftarget"]).resolve()
        if target.is_relative_to(docs) or not target.with_suffix(".md").is_file():
            continue
        page = PAGES.get(target.stem) if target.parent == docs.parent else None
        if page is not None:
            link["refdomain"], link["reftarget"] = "doc", page
            link.attributes.setdefault("reftargetid", None)
        else:
            path = f"/{os.path.relpath(target.with_suffix('.md'), docs)}"
            link.replace_self(
                addnodes.download_reference("", "", *link.children, reftarget=path, refdomain=None)
            )


def setup(app: Sphinx) -> dict[str, bool]:
    """Links are looked at when a page was read, before Sphinx collects the downloads."""
    app.connect("doctree-read", _resolve, priority=400)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
