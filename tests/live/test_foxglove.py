"""Estimates by the protocol of Foxglove, for a client of the tests."""

import json
import struct
import subprocess
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import pytest
from websocket import ABNF, WebSocket, create_connection

from sender import csv, ended, free_port, messages, of_joints, running

pytest.importorskip("foxglove")


def replayed(
    folder: Path, samples: int, port: int
) -> AbstractContextManager[subprocess.Popen[str]]:
    """The command with a log, whose estimates go to a port; both joints have the same columns."""
    (folder / "arm.csv").write_text("\n".join(csv(messages(samples))) + "\n")
    options = ["--replay", "arm.csv", "--to", f"foxglove:{port}"]
    return running(folder, *options, text=of_joints(["elbow", "wrist"]))


class Client:
    """Parts of the protocol: channels by topic, and the messages of one channel."""

    def __init__(self, port: int) -> None:
        address = f"ws://127.0.0.1:{port}"
        self.socket: WebSocket = create_connection(
            address, timeout=10, subprotocols=["foxglove.sdk.v1"]
        )
        self.channels: dict[str, Any] = {}
        while len(self.channels) < 3:
            message = json.loads(self.socket.recv())
            self.channels |= {each["topic"]: each for each in message.get("channels", [])}

    def subscribe(self, topic: str) -> None:
        subscription = {"id": 7, "channelId": self.channels[topic]["id"]}
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": [subscription]}))

    def next_bytes(self) -> tuple[int, bytes]:
        """Time [ns] and contents of the next message."""
        while True:
            kind, data = self.socket.recv_data()
            if kind == ABNF.OPCODE_BINARY and data[0] == 1:
                _, subscription, stamp = struct.unpack_from("<BIQ", data)
                assert subscription == 7
                return stamp, data[13:]

    def next(self) -> tuple[int, Any]:
        stamp, data = self.next_bytes()
        return stamp, json.loads(data)


def test_a_client_receives_channels_and_samples(tmp_path: Path) -> None:
    port = free_port()
    with replayed(tmp_path, 4000, port) as process:
        client = Client(port)
        assert sorted(client.channels) == ["/elbow/estimate", "/sigmahat/events", "/wrist/estimate"]
        channel = client.channels["/wrist/estimate"]
        assert (channel["encoding"], channel["schemaEncoding"]) == ("json", "jsonschema")
        properties = json.loads(channel["schema"])["properties"]
        assert "[N.m/rad]" in properties["sigma"]["description"]
        client.subscribe("/wrist/estimate")
        stamp, first = client.next()
        assert set(first) == set(properties)
        later, _ = client.next()
        assert later - stamp == 2_000_000
        client.socket.close()
        client = Client(port)  # a viewer that comes back
        client.subscribe("/elbow/estimate")
        values = [client.next()[1] for _ in range(500)]
        assert values[-1]["sigma_low"] < values[-1]["sigma"] < values[-1]["sigma_high"]
        ended(process)
    layout = json.loads((tmp_path / "out" / "foxglove-layout.json").read_text())
    assert [tab["title"] for tab in layout["content"]["tabs"]] == ["elbow", "wrist"]
    assert '"/elbow/estimate.sigma_low"' in json.dumps(layout)


def test_events_are_messages_of_a_log(tmp_path: Path) -> None:
    """Two fields are missing; the replay takes long enough for the client to be there."""
    sent = messages(4000)
    for each in sent[2000:]:
        each["arm/motor"] = each["arm/torque"] = float("nan")
    (tmp_path / "arm.csv").write_text("\n".join(csv(sent)) + "\n")
    port = free_port()
    options = ["--replay", "arm.csv", "--to", f"foxglove:{port}"]
    with running(tmp_path, *options, text=of_joints(["elbow", "wrist"])) as process:
        client = Client(port)
        assert client.channels["/sigmahat/events"]["schemaName"] == "foxglove.Log"
        client.subscribe("/sigmahat/events")
        stamp, entry = client.next_bytes()
        assert b"no 'arm/motor', 'arm/torque' for 0." in entry
        assert 4.4e9 < stamp < 5.5e9
        _, err = ended(process)
    assert "no 'arm/motor', 'arm/torque' for 0." in err
