"""A WebSocket server for Foxglove: a topic /JOINT/estimate for each joint, and a layout to load."""

import json
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import foxglove

from sigmahat.fmi.model import installed_model
from sigmahat.fmi.series import schema
from sigmahat.live.live_joint import BANDED, GIVEN, Estimated, LiveJoint
from sigmahat.live.loop import Sink


def serve(address: tuple[str, int], joints: Sequence[LiveJoint]) -> Sink:
    """Starts the server. Raises RuntimeError if the address is not available."""
    foxglove.set_log_level("CRITICAL")  # no messages about viewers that disconnect
    foxglove.start_server(name="sigmahat", host=address[0], port=address[1])
    channel = partial(foxglove.Channel, message_encoding="json")
    channels = {j.name: channel(f"/{j.name}/estimate", schema=_schema()) for j in joints}

    def send(ticks: Sequence[Estimated]) -> None:
        for each in ticks:
            channels[each.joint].log(each.shown(), log_time=max(round(1e9 * each.t), 0))

    return send


def _schema() -> foxglove.Schema:
    model = installed_model("StiffnessEstimator")
    described = schema(model, GIVEN)
    for of in BANDED:
        text = f"end of the 95 % interval of {of} [{model.variable(of).unit}]"
        for end in ("low", "high"):
            described["properties"][f"{of}_{end}"] = {"type": "number", "description": text}
    data = json.dumps(described).encode()
    return foxglove.Schema(name="sigmahat.Estimate", encoding="jsonschema", data=data)


def write_layout(joints: Sequence[LiveJoint], folder: Path) -> None:
    """Writes a layout for Foxglove: a tab for each joint, with stiffness, torque and doubt."""
    tabs = []
    for joint in joints:
        topic = f"/{joint.name}/estimate"
        doubt = {"paths": [{"value": f"{topic}.doubt", "label": "doubt"}]}
        panels = [
            _plot(topic, "sigma", "Stiffness [N.m/rad]"),
            _plot(topic, "tau_e", "Flexibility torque [N.m]"),
            _panel("StateTransitions", "Why the stiffness is not confident", doubt),
        ]
        items = [{"proportion": 1, "content": each} for each in panels]
        content = {"type": "split", "direction": "column", "items": items}
        tabs.append({"title": joint.name, "content": content})
    layout = {"version": 1, "content": {"type": "tabs", "selectedTabIndex": 0, "tabs": tabs}}
    (folder / "foxglove-layout.json").write_text(json.dumps(layout), encoding="utf-8")


def _plot(topic: str, name: str, title: str) -> dict[str, Any]:
    paths = [{"value": f"{topic}.{name}", "label": name, "lineSize": 2}] + [
        {"value": f"{topic}.{name}_{end}", "label": label, "lineStyle": "dashed", "lineSize": 1}
        for end, label in (("low", "95 % from"), ("high", "to"))
    ]
    config = {"paths": paths, "yAxisLabel": title, "showLegend": True, "followingViewWidth": 20}
    return _panel("Plot", title, config)


def _panel(kind: str, title: str, config: dict[str, Any]) -> dict[str, Any]:
    return {"type": "panel", "panelType": kind, "title": title, "version": 1, "config": config}
