"""A WebSocket server for Foxglove: a topic /JOINT/estimate for each joint, one for the events, and
a layout to load.
"""

import json
import logging
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Any

import foxglove
from foxglove.channels import LogChannel
from foxglove.messages import Log, LogLevel, Timestamp

from sigmahat.files.output import write_whole
from sigmahat.fmi.model import installed_model
from sigmahat.fmi.series import schema
from sigmahat.live.events import Event
from sigmahat.live.live_joint import BANDED, GIVEN, JUMPED, NO_DATA, LiveJoint, News
from sigmahat.live.loop import Sink

EVENTS = "/sigmahat/events"  # topic of the events, as Foxglove's own messages of a log


def serve(address: tuple[str, int], joints: Sequence[LiveJoint]) -> Sink:
    """Starts the server. Raises RuntimeError if the address is not available."""
    _silence_the_sdk()
    foxglove.start_server(name="sigmahat", host=address[0], port=address[1])
    channel = partial(foxglove.Channel, message_encoding="json")
    channels = {j.name: channel(f"/{j.name}/estimate", schema=_schema()) for j in joints}
    events = LogChannel(EVENTS)

    def send(news: Sequence[News]) -> None:
        for each in news:
            time = max(round(1e9 * each.t), 0)
            if isinstance(each, Event):
                events.log(_entry(each, time), log_time=time)
            else:
                channels[each.joint].log(each.shown(), log_time=time)

    return send


def _silence_the_sdk() -> None:
    """Switches off the messages of the SDK about viewers that disconnect.

    The SDK also sets level and handler of Python's root logger, which would drop the warnings of
    everybody else. So the function puts them back.
    """
    root = logging.getLogger()
    level, handlers = root.level, root.handlers[:]
    foxglove.set_log_level("CRITICAL")
    root.setLevel(level)
    root.handlers[:] = handlers


def _entry(event: Event, time: int) -> Log:
    level = LogLevel.Warning if event.is_warning else LogLevel.Info
    stamp = Timestamp(*divmod(time, 1_000_000_000))
    return Log(timestamp=stamp, level=level, message=event.in_words, name=event.kind)


def _schema() -> foxglove.Schema:
    model = installed_model("StiffnessEstimator")
    described = schema(model, GIVEN)
    for of in BANDED:
        text = f"end of the 95 % interval of {of} [{model.variable(of).unit}]"
        for end in ("low", "high"):
            described["properties"][f"{of}_{end}"] = {"type": "number", "description": text}
    described["properties"]["doubt"]["description"] += (
        f"; {NO_DATA} while no data arrive; {JUMPED} after a position has jumped"
    )
    age = "time since the last tick with data, while no data arrive, else 0 [s]"
    described["properties"]["data_age"] = {"type": "number", "description": age}
    data = json.dumps(described).encode()
    return foxglove.Schema(name="sigmahat.Estimate", encoding="jsonschema", data=data)


def write_layout(joints: Sequence[LiveJoint], folder: Path) -> None:
    """Writes a layout for Foxglove: a tab for each joint, with stiffness, torque, doubt, events."""
    tabs = []
    for joint in joints:
        topic = f"/{joint.name}/estimate"
        doubt = {"paths": [{"value": f"{topic}.doubt", "label": "doubt"}]}
        panels = [
            _plot(topic, "sigma", "Stiffness [N.m/rad]"),
            _plot(topic, "tau_e", "Flexibility torque [N.m]"),
            _panel("StateTransitions", "Why the stiffness is not confident", doubt),
            _panel("Log", "Events", {"topicToRender": EVENTS, "minLogLevel": 1}),
        ]
        items = [{"proportion": 1, "content": each} for each in panels]
        content = {"type": "split", "direction": "column", "items": items}
        tabs.append({"title": joint.name, "content": content})
    layout = {"version": 1, "content": {"type": "tabs", "selectedTabIndex": 0, "tabs": tabs}}
    write_whole(json.dumps(layout), folder / "foxglove-layout.json")


def _plot(topic: str, name: str, title: str) -> dict[str, Any]:
    paths = [{"value": f"{topic}.{name}", "label": name, "lineSize": 2}] + [
        {"value": f"{topic}.{name}_{end}", "label": label, "lineStyle": "dashed", "lineSize": 1}
        for end, label in (("low", "95 % from"), ("high", "to"))
    ]
    config = {"paths": paths, "yAxisLabel": title, "showLegend": True, "followingViewWidth": 20}
    return _panel("Plot", title, config)


def _panel(kind: str, title: str, config: dict[str, Any]) -> dict[str, Any]:
    return {"type": "panel", "panelType": kind, "title": title, "version": 1, "config": config}
