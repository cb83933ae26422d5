"""A WebSocket server for Foxglove: a topic /JOINT/estimate for each joint, and a layout to load."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

import foxglove
from foxglove.layouts import (
    Content,
    Layout,
    PlotConfig,
    PlotPanel,
    PlotSeries,
    SplitContainer,
    SplitItem,
    StateTransitionsConfig,
    StateTransitionsPanel,
    StateTransitionsSeries,
    TabContainer,
    TabItem,
)

from sigmahat.fmi.json_schema import schema
from sigmahat.live.joint import GIVEN, Estimated, LiveJoint
from sigmahat.live.sinks import BANDS, Sink, shown

LAYOUT = "foxglove-layout.json"
"""Name of the file of the layout."""


def serve(address: tuple[str, int], joints: Sequence[LiveJoint]) -> Sink:
    """Raises RuntimeError if the address cannot be had."""
    foxglove.set_log_level("CRITICAL")  # that a viewer has gone is no news
    foxglove.start_server(name="sigmahat", host=address[0], port=address[1])
    channels = {
        joint.configuration.joint: foxglove.Channel(
            _topic(joint), schema=_schema(joint), message_encoding="json"
        )
        for joint in joints
    }

    def send(ticks: Sequence[Estimated]) -> None:
        for each in ticks:
            stamp = max(round(1e9 * each.t), 0)
            channels[each.joint].log(shown(each.outputs), log_time=stamp)

    return send


def write_layout(joints: Sequence[LiveJoint], folder: Path) -> None:
    """Writes a layout for Foxglove: a tab for each joint, with stiffness, torque and doubt."""
    tabs = [TabItem(title=_name(joint), content=_of_joint(_topic(joint))) for joint in joints]
    layout = Layout(content=TabContainer(tabs=tabs))
    (folder / LAYOUT).write_text(layout.to_json(), encoding="utf-8")


def _of_joint(topic: str) -> Content:
    panels: list[Content] = [
        _plot(topic, "sigma", "Stiffness [N.m/rad]"),
        _plot(topic, "tau_e", "Flexibility torque [N.m]"),
        StateTransitionsPanel(
            title="Why the stiffness is not confident",
            config=StateTransitionsConfig(
                paths=[StateTransitionsSeries(value=f"{topic}.doubt", label="doubt")]
            ),
        ),
    ]
    return SplitContainer(direction="column", items=[SplitItem(content=each) for each in panels])


def _plot(topic: str, name: str, title: str) -> PlotPanel:
    """An output with its 95 % band."""
    band = [
        PlotSeries(value=f"{topic}.{name}_{end}", label=label, line_style="dashed", line_size=1)
        for end, label in (("low", "95 % from"), ("high", "to"))
    ]
    paths = [PlotSeries(value=f"{topic}.{name}", label=name, line_size=2), *band]
    config = PlotConfig(paths=paths, y_axis_label=title, show_legend=True, following_view_width=20)
    return PlotPanel(title=title, config=config)


def _schema(joint: LiveJoint) -> foxglove.Schema:
    described = schema(joint.slave.fmu, GIVEN)
    for name, of in BANDS.items():
        unit = joint.slave.fmu.variable(of).unit
        described["properties"][name] = {
            "type": "number",
            "description": f"end of the 95 % interval of {of} [{unit}]",
        }
    return foxglove.Schema(
        name="sigmahat.Estimate", encoding="jsonschema", data=json.dumps(described).encode()
    )


def _name(joint: LiveJoint) -> str:
    return joint.configuration.joint or "joint"


def _topic(joint: LiveJoint) -> str:
    return f"/{_name(joint)}/estimate"
