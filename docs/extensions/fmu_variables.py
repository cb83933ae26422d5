"""Directive `fmu-variables`: tables of the variables of an FMU, from its model description.

    ```{fmu-variables} StiffnessEstimator
    ```

Parameters are grouped by the first part of their names. Each variable is an object of the site, so
that a search finds its whole name and leads to its row.
"""

from collections.abc import Iterable, Iterator, Mapping
from itertools import groupby
from pathlib import Path
from typing import Any

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective

from sigmahat.plant_fmu.model_description import UNITS
from sigmahat_build.description_template import render
from sigmahat_build.documentation import table as variables_of

COLUMNS = {"name": 20, "unit": 10, "start": 15, "range": 15, "description": 40}
OBJECT = "fmu-variable"
Row = Mapping[str, Any]


class FmuVariables(SphinxDirective):
    """Sections with the inputs, the outputs and the groups of parameters of one FMU."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        fmu = self.arguments[0]
        template = Path(self.env.srcdir).parent / "modelDescription" / f"{fmu}.xml"
        # A template extends and includes others.
        for path in (*template.parent.glob("*.xml"), UNITS):
            self.env.note_dependency(path)
        root = render(template, self.config.version)
        return [
            self._section(fmu, title, rows)
            for causality in ("input", "output", "parameter")
            for title, rows in _groups(causality, variables_of(root, causality))
        ]

    def _section(self, fmu: str, title: str, rows: list[Row]) -> nodes.section:
        section = nodes.section("", nodes.title("", title), ids=[nodes.make_id(f"{fmu}-{title}")])
        group = nodes.tgroup("", cols=len(COLUMNS))
        group += [nodes.colspec("", colwidth=width) for width in COLUMNS.values()]
        group += nodes.thead("", _row(nodes.paragraph("", heading) for heading in COLUMNS))
        group += nodes.tbody("", *(self._variable(f"{fmu}.{row['name']}", row) for row in rows))
        section += nodes.table("", group, classes=["fmu-variables"])
        return section

    def _variable(self, name: str, row: Row) -> nodes.row:
        anchor = nodes.make_id(name)
        self.env.domains.standard_domain.note_object(OBJECT, name, anchor)
        title = nodes.paragraph("", "", nodes.literal("", row["name"]), ids=[anchor])
        tunable = " (tunable)" if row["variability"] == "tunable" else ""
        description: list[nodes.Node] = [nodes.paragraph("", row["description"] + tunable)]
        if row["choices"]:
            description.append(nodes.bullet_list("", *map(_choice, row["choices"])))
        values = (nodes.paragraph("", row[column]) for column in ("unit", "start", "range"))
        return _row([title, *values, description])


def _groups(causality: str, found: Mapping[str, Any]) -> Iterator[tuple[str, list[Row]]]:
    rows = [*found["single"], *(_array(name, each) for name, each in found["arrays"].items())]
    if causality != "parameter":
        yield f"{causality.capitalize()}s", rows
        return
    rows.sort(key=_prefix)  # stable: else the order of the model description stays
    for prefix, group in groupby(rows, _prefix):
        yield f"Parameters {prefix}.*" if prefix else "Parameters without a group", list(group)


def _prefix(row: Row) -> str:
    return str(row["name"]).rpartition(".")[0]


def _array(name: str, elements: list[Row]) -> Row:
    """One row for all elements, with the description of the first."""
    first, last = elements[0], elements[-1]["name"]
    text = f"{len(elements)} elements, {first['name']} to {last}. The first: {first['description']}"
    return {**first, "name": name, "description": text}


def _choice(item: Mapping[str, str]) -> nodes.list_item:
    name = nodes.literal("", item["name"])
    text = nodes.Text(f" ({item['value']}): {item['description']}")
    return nodes.list_item("", nodes.paragraph("", "", name, text))


def _row(cells: Iterable[nodes.Node | list[nodes.Node]]) -> nodes.row:
    found = (cell if isinstance(cell, list) else [cell] for cell in cells)
    return nodes.row("", *(nodes.entry("", *cell) for cell in found))


def setup(app: Sphinx) -> dict[str, bool]:
    app.add_object_type(OBJECT, OBJECT, objname="variable")
    app.add_directive("fmu-variables", FmuVariables)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
