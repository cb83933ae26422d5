"""``sigmahat-awas.ssp``: plant and estimator as a complete system in the format SSP 1.0.

The scenario ``table1`` with the estimator RESIDUAL gives the connections and parameters.
"""

from collections.abc import Iterable, Mapping
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

from sigmahat import result
from sigmahat.experiments.scenario import Scenario
from sigmahat.files.templates import environment
from sigmahat.fmi.instance import Fmu
from sigmahat.fmi.model import Value
from sigmahat.paper.scenarios import scenario
from sigmahat.plant_fmu import archive


def write(ssp: Path, plant: Path, estimator: Path, templates: Path, version: str) -> None:
    """Write the SSP of this version from the two FMUs and the folder of its Jinja2 templates.

    Equal FMUs and templates give equal bytes.
    """
    table1 = scenario("table1")
    residual = table1.estimators["RESIDUAL"]
    connections = residual.connections
    jinja = environment(templates, Path(result.__file__).with_name("templates"))
    with Fmu(plant) as of_plant, Fmu(estimator) as of_estimator, TemporaryDirectory() as folder:
        units = {u.name: u for f in (of_plant, of_estimator) for u in f.description.unitDefinitions}
        sent = dict.fromkeys((*connections.values(), "sigma"))
        data = {
            "version": version,
            "connections": connections,
            "duration": table1.duration,
            "step": table1.T,
            "units": units.values(),
            "plant": _element("plant", of_plant, plant, (), sent),
            "estimator": _element("estimator", of_estimator, estimator, connections, ["sigma"]),
        }
        contents = {f"resources/{fmu.name}": fmu for fmu in (plant, estimator)}

        def add(name: str, template: str, **more: Any) -> None:
            contents[name] = Path(folder) / Path(name).name
            text = jinja.get_template(template).render(data, **more)
            contents[name].write_text(text, encoding="utf-8")

        add("SystemStructure.ssd", "SystemStructure.ssd")
        for element, fmu, start in (
            ("plant", of_plant, {**table1.plant.start, **torques(table1)}),
            ("estimator", of_estimator, residual.start),
        ):
            # One name for both: ecos applies the parameter sets of one name only.
            more = {"element": "table1", "comments": (), "parameters": _parameters(fmu, start)}
            add(f"resources/{element}.ssv", "parameters.ssv", **more)
        archive.write(ssp, contents)


def torques(table1: Scenario) -> dict[str, Value]:
    """The torques of the scenario, all of them sines, as those that the plant adds to its inputs.

    So the system moves without other inputs.
    """
    return {
        f"signal.{name}.{part}": getattr(signal, part)
        for name, signal in table1.plant.inputs.items()
        for part in ("amplitude", "frequency")
    }


def _element(
    name: str, fmu: Fmu, path: Path, inputs: Iterable[str], outputs: Iterable[str]
) -> dict[str, Any]:
    return {
        "name": name,
        "fmu": path.name,
        "description": fmu.description.description,
        "input": {n: fmu.variable(n, "input").unit for n in inputs},
        "output": {n: fmu.variable(n, "output").unit for n in outputs},
    }


def _parameters(fmu: Fmu, start: Mapping[str, Value]) -> list[tuple[Any, str]]:
    """All parameters except enumerations, and initial estimates, which are zero.

    Importers disagree on the form of an enumeration: the standard requires the name of the item,
    FMPy requires its number. So enumerations keep the start values of the FMU, which are those of
    the scenario.
    """
    listed = []
    for name, value in fmu.parameters(start).items():
        variable = fmu.variable(name)
        if variable.type != "Enumeration" and not name.startswith("rls.eta_0"):
            text = str(bool(value)).lower() if variable.type == "Boolean" else repr(value)
            listed.append((variable, text))
    return listed
