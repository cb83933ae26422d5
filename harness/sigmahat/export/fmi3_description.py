"""The model description for FMI 3.0, from that for FMI 2.0.

Names, value references and scalars are the same, and the instantiation token is the GUID. What
differs: the types have other names, and there is a variable for time, whose reference follows the
others.
"""

import copy
from collections.abc import Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from sigmahat.export.templates import variables

_TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "Enumeration": "Enumeration"}


def twin(root: Element) -> Element:
    """Model description of FMI 3.0 for the complete one of FMI 2.0, which is left as it is."""
    made = Element("fmiModelDescription", {**root.attrib, "fmiVersion": "3.0"})
    made.set("instantiationToken", made.attrib.pop("guid"))
    (identifier,) = (e.attrib["modelIdentifier"] for e in root.findall("CoSimulation"))
    ElementTree.SubElement(
        made,
        "CoSimulation",
        modelIdentifier=identifier,
        canGetAndSetFMUState="true",
        canSerializeFMUState="true",
        canHandleVariableCommunicationStepSize="true",
    )
    for part in ("UnitDefinitions", "TypeDefinitions", "LogCategories", "DefaultExperiment"):
        made.extend(map(copy.deepcopy, root.findall(part)))
    for definition in made.findall("TypeDefinitions"):
        _convert_types(definition)
    for units in made.findall("UnitDefinitions"):
        _add_second(units)
    for categories in made.findall("LogCategories"):  # FMI 3.0 has no requests for status
        categories.remove(categories.findall("Category[@name='logStatusDiscard']")[0])
    made.append(_model_variables(root))
    made.append(_model_structure(root))
    ElementTree.indent(made)
    return made


def _convert_types(definitions: Element) -> None:
    for simple in list(definitions):
        converted = ElementTree.SubElement(definitions, "EnumerationType", simple.attrib)
        converted.extend(simple.findall("Enumeration/Item"))
        definitions.remove(simple)


def _add_second(units: Element) -> None:
    """The unit of time, for FMUs that use it for nothing else."""
    if units.find("Unit[@name='s']") is None:
        ElementTree.SubElement(ElementTree.SubElement(units, "Unit", name="s"), "BaseUnit", s="1")


def _model_variables(root: Element) -> Element:
    made = Element("ModelVariables")
    listed = variables(root)
    for variable in listed:
        kind = variable[0]
        ElementTree.SubElement(made, _TYPES[kind.tag], {**variable.attrib, **kind.attrib})
    ElementTree.SubElement(
        made,
        "Float64",
        name="time",
        valueReference=str(len(listed)),
        causality="independent",
        variability="continuous",
        unit="s",
        description="Simulation time",
    )
    return made


def _model_structure(root: Element) -> Element:
    """Outputs and initial unknowns, by value references instead of indices from 1."""
    made = Element("ModelStructure")
    for part, tag in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        for unknown in root.findall(f"ModelStructure/{part}/Unknown"):
            known = [str(int(i) - 1) for i in unknown.attrib["dependencies"].split()]
            ElementTree.SubElement(
                made,
                tag,
                valueReference=str(int(unknown.attrib["index"]) - 1),
                dependencies=" ".join(known),
                dependenciesKind=" ".join(["dependent"] * len(known)),
            )
    return made


def build_description(identifier: str, sources: Sequence[str]) -> Element:
    """``sources/buildDescription.xml``: the C files that an importer has to compile."""
    root = Element("fmiBuildDescription", fmiVersion="3.0")
    configuration = ElementTree.SubElement(
        root, "BuildConfiguration", modelIdentifier=identifier, description="C99"
    )
    files = ElementTree.SubElement(configuration, "SourceFileSet", language="C99")
    for source in sources:
        ElementTree.SubElement(files, "SourceFile", name=source)
    ElementTree.indent(root)
    return root


def terminals_and_icons(root: Element) -> Element:
    """``terminalsAndIcons/terminalsAndIcons.xml``: the icon, and the measurements as a bus.

    A plant has the terminal ``measurements`` with what its sensors give, an estimator one of the
    same name with its inputs. Members of one name belong together, so that a tool which knows
    terminals connects both in one go.
    """
    made = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    shown = ElementTree.SubElement(made, "GraphicalRepresentation")
    corners = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    ElementTree.SubElement(shown, "CoordinateSystem", corners, suggestedScalingFactorTo_mm="0.1")
    ElementTree.SubElement(shown, "Icon", corners)
    members = dict(_measurements(root))
    if members:
        listed = ElementTree.SubElement(made, "Terminals")
        terminal = ElementTree.SubElement(
            listed,
            "Terminal",
            name="measurements",
            matchingRule="bus",
            terminalKind="org.sigmahat.measurements",
            description="Measured positions and torques of the joint",
        )
        for name, member in members.items():
            ElementTree.SubElement(
                terminal,
                "TerminalMemberVariable",
                variableName=name,
                memberName=member,
                variableKind="signal",
            )
    ElementTree.indent(made)
    return made


def _measurements(root: Element) -> list[tuple[str, str]]:
    """Variables of the terminal and their names in it."""
    names = [(v.attrib["causality"], v.attrib["name"]) for v in variables(root)]
    measured = [name for kind, name in names if kind == "output" and "_measured" in name]
    if measured:
        return [(name, name.replace("_measured", "")) for name in measured]
    return [(name, name.replace("_sensor", "")) for kind, name in names if kind == "input"]
