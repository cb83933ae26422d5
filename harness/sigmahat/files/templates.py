"""Configures Jinja2 for the templates of the package and of the model descriptions."""

from pathlib import Path

import jinja2


def environment(*folders: Path, autoescape: bool = True) -> jinja2.Environment:
    """Creates a Jinja2 environment for template folders; an undefined name is an error."""
    loader = jinja2.FileSystemLoader(folders)
    return jinja2.Environment(
        loader=loader, undefined=jinja2.StrictUndefined, autoescape=autoescape
    )
