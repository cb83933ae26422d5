"""Texts of strangers end no string, comment or element of any file that the commands make.

Results are forged as files, which a schema reads, and also in memory, behind the schema.
"""

import json
import os
import random
import re
import sys
from collections.abc import Callable, Iterator
from dataclasses import fields, is_dataclass, replace
from pathlib import Path
from typing import Any
from xml.etree.ElementTree import Element, SubElement

import numpy as np
import pytest
import tomlkit
import yaml
from bokeh.document import Document
from bokeh.embed import file_html
from bokeh.models import Div
from bokeh.resources import CDN

from command_line import in_process, one_line, working_in
from hostile_text import MARK, Page, forge, hostile, hostile_name, is_outside, names_in_xml
from recorded_logs import REGRESSION, awas_log, estimated
from sigmahat.checks.findings import Checked, Finding, Kind, Severity
from sigmahat.estimator.estimator import Estimator
from sigmahat.fmi.model import installed_model
from sigmahat.guess import template
from sigmahat.guess.columns import read_columns
from sigmahat.guess.guess import guess
from sigmahat.motion import files
from sigmahat.motion.joints_of_log import Multisine
from sigmahat.plant_fmu.c_variables import c_table
from sigmahat.recording.configuration import PORTS, checked_configuration
from sigmahat.recording.log import LogError, LogInMemory
from sigmahat.recording.several_joints import JOINTS
from sigmahat.report import from_log, page
from sigmahat.result import parameter_file, robot_model
from sigmahat.result.estimate import JOINTS as TABLE_OF_JOINTS
from sigmahat.result.estimate_table import REPLAYED
from sigmahat.result.learned import continue_from, read_learned
from sigmahat.result.sheet import FORMAT
from sigmahat.setup_page.background import guessed
from sigmahat.setup_page.edits import set_value
from sigmahat.setup_page.setup import Look, Setup
from sigmahat.setup_page.window import Window

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

DRAWS = 10_000 if os.environ.get("SIGMAHAT_COMPLETE") else 100
LANGUAGES = {
    **dict.fromkeys(("ssv", "mjcf", "sdf", "urdf", "drake"), "xml"),
    **{"matlab": "matlab", "modelica": "modelica"},
}
"""Kinds of `export`, by language."""
SHARES = {
    **dict.fromkeys(LANGUAGES, 4),
    **{
        "report": 2,
        "joints": 1,
        "page": 1,
        "configuration": 3,
        "motion": 2,
        "plant": 3,
        "state": 3,
    },
}
"""Shares of the draws: a page takes as long as thirty models of a joint."""
TURNS = [target for target, share in SHARES.items() for _ in range(share)]
LONGEST = 1500  # characters of a message besides paths
Random = random.Random


def draws(target: str) -> Iterator[Random]:
    for i in range(DRAWS):
        if TURNS[i % len(TURNS)] == target:
            yield Random(i)


def in_texts(value: Any, draw: Random) -> Any:
    """Replaces some texts in a tree of dataclasses, lists and dictionaries, keys excluded."""
    if isinstance(value, str):
        return hostile(draw) if draw.random() < 0.3 else value
    if is_dataclass(value) and not isinstance(value, type):
        names = {each.name for each in fields(value)} - {"start_values", "kind", "color"}
        forged = {name: in_texts(getattr(value, name), draw) for name in sorted(names)}
        return replace(value, **forged)
    if isinstance(value, dict):
        kept = ("kind", "severity")  # by which the sentence is chosen
        return {k: each if k in kept else in_texts(each, draw) for k, each in value.items()}
    if isinstance(value, list):
        return [in_texts(each, draw) for each in value]
    return value


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with results of a short log."""
    options = "prior.B = 0.2\nprior.tau_coulomb = 0.01\n"
    folder = tmp_path_factory.mktemp("knee")
    return estimated(folder, awas_log(1.0, 0.3, 0.5), REGRESSION + options, "--out knee") / "knee"


@pytest.fixture
def folder(results: Path, tmp_path: Path) -> Iterator[Path]:
    """A copy of the results without most points of the curve, which take time to read."""
    for path in results.iterdir():
        (tmp_path / path.name).write_bytes(path.read_bytes())
    sheet = json.loads((tmp_path / FORMAT.file).read_text())
    sheet["curve"] = sheet["curve"][:2]
    (tmp_path / FORMAT.file).write_text(json.dumps(sheet))
    with working_in(tmp_path):
        yield tmp_path


def written(kind: str, sheet: Any, path: Path) -> str:
    if kind in parameter_file.KINDS:
        parameter_file.write(sheet, installed_model("StiffnessEstimator"), kind, path)
    else:
        robot_model.write_model(sheet, kind, path)
    return path.read_bytes().decode()


def forged_file(path: Path, text: str, draw: Random) -> None:
    document = json.loads(text)
    forge(document, draw, hostile)
    path.write_text(json.dumps(document))


@pytest.mark.parametrize("kind", LANGUAGES)
def test_exports(kind: str, folder: Path) -> None:
    sheet, text = FORMAT.read(folder), (folder / FORMAT.file).read_text()
    language = LANGUAGES[kind]
    known = names_in_xml(written(kind, sheet, folder / "usual")) if language == "xml" else set()
    files = 0
    for draw in draws(kind):
        name = hostile_name(draw) if language == "xml" and draw.random() < 0.3 else "knee"
        if draw.random() < 0.5:
            forged_file(folder / FORMAT.file, text, draw)
            done = in_process("export", ".", "--to", kind, "--force", "--out", "knee", cwd=folder)
            if done.returncode:
                assert len(one_line(done)) < LONGEST
                continue
            exported = (folder / "knee").read_bytes().decode()
        elif kind == "ssv" and not Path(name).stem.isprintable():
            with pytest.raises(ValueError, match="expected characters that print"):
                written(kind, sheet, folder / name)
            continue
        else:
            exported = written(kind, in_texts(sheet, draw), folder / name)
        files += 1
        if language == "xml":
            assert names_in_xml(exported) <= known
        else:
            assert not is_outside(language, exported)
    assert files > len([*draws(kind)]) // 3


def check_page(text: str, known: Page) -> None:
    made = Page(text)
    assert made.names <= known.names
    assert not any(address.lower().startswith("javascript") for address in made.addresses)
    for script in made.scripts:
        if MARK in script:
            assert not is_outside("javascript", script)
            assert not any(end in script.lower() for end in ("<!--", "</script"))


def test_reports(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """One of twenty reports has plots, which take time."""
    contents, out = from_log.from_log(folder), folder / "report.html"
    plots = [*contents.panels[:2]]
    known = Page(page.page(replace(contents, panels=plots, answer=()), out))
    beside = from_log._beside_the_table(folder)
    texts = {name: (folder / name).read_text() for name in (FORMAT.file, REPLAYED.file)}
    for i, draw in enumerate(draws("report")):
        panels = in_texts(plots, draw) if i % 20 == 0 else ()
        name = draw.choice([*texts])
        with monkeypatch.context() as patch:
            if draw.random() < 0.5:
                forged_file(folder / name, texts[name], draw)
            else:
                forged = [in_texts(each, draw) for each in beside[:2]]
                patch.setattr(from_log, "_beside_the_table", returning((*forged, *beside[2:])))
            try:
                made = replace(from_log.from_log(folder), panels=panels, answer=())
                check_page(page.page(made, out), known)
            except ValueError as error:
                assert len(str(error)) < LONGEST + len(str(folder))
        (folder / name).write_text(texts[name])


def returning(value: Any) -> Callable[[Path], Any]:
    return lambda _: value


def test_a_table_of_joints_names_no_other_folder(folder: Path) -> None:
    """GIVEN a forged joints.csv, THEN only folders in its folder are read and written."""
    inside = folder / "legs"
    inside.mkdir()
    (inside / "knee").symlink_to(folder)
    names = ["../", "..", "/etc", "a/../..", "C:\\x", "", ".hidden", *map(hostile, draws("joints"))]
    for name in names:
        if re.fullmatch(r"\w[\w.-]*", name):  # a possible name
            continue
        quoted = '"' + name.replace('"', '""').encode(errors="replace").decode() + '"'
        (inside / TABLE_OF_JOINTS).write_text(f"joint,setPoint\nknee,1\n{quoted},1\n")
        for command in (["report", "."], ["export", ".", "--to", "sdf", "--force"]):
            before = {*folder.iterdir()}
            done = in_process(*command, cwd=inside)
            assert done.returncode == 2 and len(one_line(done)) < LONGEST
            assert {*folder.iterdir()} == before


def hostile_log(draw: Random) -> LogInMemory:
    """A log whose names of columns mean something, and have hostile texts before or behind."""
    t = 1e-3 * np.arange(100.0)
    motion = np.sin(60 * t) + 0.01 * np.sin(400 * t)
    columns = {"t": t, "motor_position": motion, "link_position": 1.01 * motion}
    columns |= {"motor_torque": 0.1 * motion, "voltage": 0 * t, "other": np.sign(motion)}

    def named(name: str) -> str:
        if draw.random() < 0.3:
            return name
        text = hostile(draw)
        return draw.choice([f"{text} {name}", f"{name} {text}", f"{text}.{name}", text])

    log = {named(name): values for name, values in columns.items()}
    return LogInMemory(Path(hostile_name(draw)), log)


SECTIONS = {"time", "ports", "parameters", JOINTS}


def check_configuration(document: dict[str, Any]) -> None:
    assert document.keys() <= SECTIONS
    assert document.get("ports", {}).keys() <= PORTS.keys()
    assert MARK not in "".join([*document.get("parameters", {}), *document.get("time", {})])
    assert all(MARK not in "".join(port) for port in document.get("ports", {}).values())
    for joint in document.get(JOINTS, {}).values():
        check_configuration(joint)


def test_configurations() -> None:
    for draw in draws("configuration"):
        log = hostile_log(draw)
        columns = read_columns(log)
        text = template.write(log, columns, guess(columns))
        check_configuration(tomllib.loads(text))
        document: Any = tomlkit.parse(text)
        with pytest.raises(LogError):  # values are left to fill in
            checked_configuration(document, Path("log.toml"))
        value = hostile(draw).encode(errors="replace").decode()
        set_value(document, "ports.q.column", value)
        again = tomllib.loads(tomlkit.dumps(document))
        check_configuration(again)
        assert again["ports"]["q"]["column"] == value


def setup_of(draw: Random, path: Path) -> Setup:
    """A setup with hostile texts wherever the page shows a text."""
    setup = Setup(hostile_log(draw), path / hostile_name(draw))
    setup.guessed(*guessed(setup.log))
    setup.looks = {name: Look(hostile(draw), hostile(draw)) for name in setup.log.columns}
    finding = Finding(
        kind=draw.choice([*Kind]),
        severity=Severity.WRONG,
        key=hostile(draw),
        measured=1.0,
        unit=hostile(draw),
        expected=2.0,
        proposed=hostile(draw),
        others=((hostile(draw), 1.0),),
        about="tau",
        row=1,
    )
    setup.checked = Checked([finding], 1, 1.0)
    setup.problem, setup.message, setup.busy = (hostile(draw) for _ in range(3))
    return setup


def shown(setup: Setup) -> Document:
    document = Document()
    Window(setup, document, lambda: None, lambda: None)
    return document


def html(document: Document) -> str:
    made: str = file_html(
        document,
        CDN,
        document.title,
        template=document.template,
        template_variables=dict(document.template_variables),
        suppress_callback_warning=True,
    )
    return made


def test_the_page(tmp_path: Path) -> None:
    """One of twenty pages is written as a whole, which takes time."""
    usual = Setup(LogInMemory(Path("log"), {"t": np.arange(100.0)}), tmp_path / "log.toml")
    known = Page(html(shown(usual)))
    elements = {"b", "small", "em", "svg", "polyline", "ul", "li", "style", "pre", "span", "br"}
    attributes = {"style", "class", "viewbox", "preserveaspectratio", "aria-hidden", "points"}
    for i, draw in enumerate(draws("page")):
        document = shown(setup_of(draw, tmp_path))
        if i % 20 == 0:
            check_page(html(document), known)
        for each in document.select({"type": Div}):
            names = Page(each.text).names
            assert {tag for tag, _ in names} <= elements
            assert {name for _, name in names} <= {"", *attributes}


def test_motions(tmp_path: Path) -> None:
    motion = Multisine([0.1], [1.0], [0.0], 0.02, 0.01)
    for draw in draws("motion"):
        name = hostile(draw)
        files.write(motion, name, 0.0, 0.01, tmp_path)
        ros = yaml.safe_load((tmp_path / "motion.yaml").read_text())
        assert ros["joint_names"] == [name.replace("\ud800", "\ufffd")]
        assert set(ros) == {"joint_names", "points"}
        assert not is_outside("c", (tmp_path / "motion.c").read_text())


def test_the_table_of_a_plant() -> None:
    for draw in draws("plant"):
        root = Element("fmiModelDescription")
        SubElement(root, "CoSimulation", modelIdentifier=hostile(draw))
        listed = SubElement(root, "ModelVariables")
        places = {}
        for place in ("u[0]", "u[1]"):
            name = hostile(draw)
            places[name] = place
            variable = SubElement(listed, "ScalarVariable", name=name, causality="input")
            SubElement(variable, "Real", start="0.0")
        assert not is_outside("c", c_table(root, "sh_plant", places, hostile(draw)))


def test_states(folder: Path) -> None:
    """GIVEN a forged state.json, THEN it is refused in one line that is not long."""
    text = (folder / "state.json").read_text()
    parameters = json.loads(text)["parameters"]
    for draw in draws("state"):
        forged_file(folder / "state.json", text, draw)
        try:
            continue_from(read_learned(folder), Estimator(parameters), Path("knee.toml"))
        except LogError as error:
            assert len(str(error)) < LONGEST + len(str(folder))
