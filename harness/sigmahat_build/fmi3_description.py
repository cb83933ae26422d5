"""The three files that describe an FMU for FMI 3.0, from its complete description for FMI 2.0."""

import copy
from collections.abc import Sequence
from xml.etree import ElementTree
from xml.etree.ElementTree import Element, SubElement

from sigmahat.plant_fmu.model_description import dependencies, variables

_TYPES = {"Real": "Float64", "Integer": "Int32", "Boolean": "Boolean", "Enumeration": "Enumeration"}


def for_fmi3(root: Element) -> Element:
    """Creates the model description of FMI 3.0 from the complete description of FMI 2.0."""
    made = Element("fmiModelDescription", {**root.attrib, "fmiVersion": "3.0"})
    made.set("instantiationToken", made.attrib.pop("guid"))
    (identifier,) = (e.attrib["modelIdentifier"] for e in root.findall("CoSimulation"))
    able = ("GetAndSetFMUState", "SerializeFMUState", "HandleVariableCommunicationStepSize")
    can = {f"can{what}": "true" for what in able}
    SubElement(made, "CoSimulation", {"modelIdentifier": identifier, **can})
    for part in ("UnitDefinitions", "TypeDefinitions", "LogCategories", "DefaultExperiment"):
        made.extend(map(copy.deepcopy, root.findall(part)))
    for definitions in made.findall("TypeDefinitions"):
        for simple in list(definitions):
            converted = SubElement(definitions, "EnumerationType", simple.attrib)
            converted.extend(simple.findall("Enumeration/Item"))
            definitions.remove(simple)
    for units in made.findall("UnitDefinitions"):
        if units.find("Unit[@name='s']") is None:  # the unit of time, which no variable has
            SubElement(SubElement(units, "Unit", name="s"), "BaseUnit", s="1")
    for categories in made.findall("LogCategories"):  # FMI 3.0 has no requests for status
        categories.remove(categories.findall("Category[@name='logStatusDiscard']")[0])
    made.append(_model_variables(root))
    made.append(_model_structure(root))
    return made


def _model_variables(root: Element) -> Element:
    made = Element("ModelVariables")
    listed = variables(root)
    for variable in listed:
        kind = variable[0]
        SubElement(made, _TYPES[kind.tag], {**variable.attrib, **kind.attrib})
    about = {"name": "time", "valueReference": str(len(listed)), "causality": "independent"}
    about |= {"variability": "continuous", "unit": "s", "description": "Simulation time"}
    SubElement(made, "Float64", about)
    return made


def _model_structure(root: Element) -> Element:
    """Creates the model structure of FMI 3.0, with value references instead of indices."""
    made = Element("ModelStructure")
    for part, tag in (("Outputs", "Output"), ("InitialUnknowns", "InitialUnknown")):
        for unknown in root.findall(f"ModelStructure/{part}/Unknown"):
            known = [int(i) - 1 for i in unknown.attrib["dependencies"].split()]
            reference = str(int(unknown.attrib["index"]) - 1)
            SubElement(made, tag, {"valueReference": reference, **dependencies(known)})
    return made


def build_description(identifier: str, sources: Sequence[str]) -> Element:
    """``sources/buildDescription.xml``: the C files that an importer has to compile."""
    files = "".join(f'<SourceFile name="{source}"/>' for source in sources)
    return ElementTree.fromstring(
        '<fmiBuildDescription fmiVersion="3.0">'
        f'<BuildConfiguration modelIdentifier="{identifier}" description="C99">'
        f'<SourceFileSet language="C99">{files}</SourceFileSet>'
        "</BuildConfiguration></fmiBuildDescription>"
    )


def terminals_and_icons(root: Element) -> Element:
    """``terminalsAndIcons/terminalsAndIcons.xml``: the icon, and the measurements as a bus.

    The terminal ``measurements`` of a plant has the outputs of the sensors, the same terminal of an
    estimator its inputs. Members with equal names belong together, so that a tool which knows
    terminals connects plant and estimator in one step.
    """
    made = Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    shown = SubElement(made, "GraphicalRepresentation")
    corners = {"x1": "-100", "y1": "-100", "x2": "100", "y2": "100"}
    SubElement(shown, "CoordinateSystem", corners, suggestedScalingFactorTo_mm="0.1")
    SubElement(shown, "Icon", corners)
    listed = [(v.attrib["causality"], v.attrib["name"]) for v in variables(root)]
    measured = [name for kind, name in listed if kind == "output" and "_measured" in name]
    members = measured or [name for kind, name in listed if kind == "input"]
    if members:
        about = {"name": "measurements", "matchingRule": "bus"}
        about["terminalKind"] = "org.sigmahat.measurements"
        about["description"] = "Measured positions and torques of the joint"
        terminal = SubElement(SubElement(made, "Terminals"), "Terminal", about)
        for name in members:
            member = name.replace("_measured" if measured else "_sensor", "")
            about = {"variableName": name, "memberName": member, "variableKind": "signal"}
            SubElement(terminal, "TerminalMemberVariable", about)
    return made
