"""Estimates by the protocol of Foxglove: a client of the tests, and the page in the browser."""

import json
import struct
import subprocess
import time
from contextlib import AbstractContextManager
from pathlib import Path
from typing import Any

import pytest
from websocket import ABNF, WebSocket, create_connection

from browser import opened
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
        while len(self.channels) < 2:
            message = json.loads(self.socket.recv())
            self.channels |= {each["topic"]: each for each in message.get("channels", [])}

    def subscribe(self, topic: str) -> None:
        subscription = {"id": 7, "channelId": self.channels[topic]["id"]}
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": [subscription]}))

    def next(self) -> tuple[int, Any]:
        """Time [ns] and contents of the next message."""
        while True:
            kind, data = self.socket.recv_data()
            if kind == ABNF.OPCODE_BINARY and data[0] == 1:
                _, subscription, stamp = struct.unpack_from("<BIQ", data)
                assert subscription == 7
                return stamp, json.loads(data[13:])


def test_a_client_receives_channels_and_samples(tmp_path: Path) -> None:
    port = free_port()
    with replayed(tmp_path, 4000, port) as process:
        client = Client(port)
        assert sorted(client.channels) == ["/elbow/estimate", "/wrist/estimate"]
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


@pytest.mark.slow("a browser watches a log at its own pace")
def test_the_page_in_the_browser_watches(site: Path, tmp_path: Path) -> None:
    port = free_port()
    address = f"{(site / 'live' / 'index.html').as_uri()}?ws=ws://127.0.0.1:{port}"
    with replayed(tmp_path, 20_000, port), opened(address) as page:
        watched = page.driver.find_element("id", "watched-sigma")
        page.until(lambda: "±" in watched.text and page.run("return watch.last.confident"))
        sigma, _, rest = watched.text.partition(" ± ")
        assert float(sigma) == pytest.approx(400, rel=0.1)
        assert rest.endswith("N·m/rad")
        options = page.run("return [...watch.field.options].map((each) => each.value)")
        assert options == ["elbow", "wrist"]
        page.run("watch.field.value = 'wrist'; watch.field.dispatchEvent(new Event('change'))")
        time.sleep(1)
        assert page.run("return watch.history.get('t').length") > 100
        assert page.complaints() == []
        policy = "return document.querySelector('meta[http-equiv]').content"
        assert f"connect-src ws://127.0.0.1:{port};" in page.run(policy)


REFUSED = """
const done = arguments[0];
document.addEventListener("securitypolicyviolation", (event) => done(event.effectiveDirective));
fetch("http://127.0.0.1:9/").catch(() => {});
"""
"""Message of the browser after an attempt to send something."""


@pytest.mark.parametrize("asked", ["?ws=http://127.0.0.1:1", "?ws=nothing", "?ws=", ""])
def test_the_page_reaches_no_other_address(asked: str, site: Path) -> None:
    with opened((site / "live" / "index.html").as_uri() + asked) as page:
        said = page.driver.find_element("id", "watch-message").text
        assert ("?ws=ws://127.0.0.1:8765" in said) == bool(asked)
        assert page.driver.execute_async_script(REFUSED) == "connect-src"
