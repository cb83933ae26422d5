"""Configures Jinja2 for the templates of the package and of the model descriptions."""

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import jinja2

from sigmahat.files.escape import xml_comment


def environment(
    *folders: Path, autoescape: bool = True, finalize: Callable[[Any], Any] | None = None
) -> jinja2.Environment:
    """Creates a Jinja2 environment for template folders; an undefined name is an error.

    autoescape  whether values are escaped for HTML and XML
    finalize    escapes each value for the language of the templates, if it is another one
    """
    loader = jinja2.FileSystemLoader(folders)
    return jinja2.Environment(
        loader=loader,
        undefined=jinja2.StrictUndefined,
        autoescape=autoescape,
        finalize=finalize,
    )


def xml(template: Path, comments: Iterable[str], **values: object) -> str:
    """Formats an XML file: comments, a line each, above the element of the template."""
    element = environment(template.parent).get_template(template.name).render(values)
    lines = ['<?xml version="1.0" encoding="UTF-8"?>', *map(xml_comment, comments), element, ""]
    return "\n".join(lines)
