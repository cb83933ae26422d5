"""What live says about messages that arrive, but with wrong times or positions."""

import math
from pathlib import Path

import pytest

from sender import CONFIGURATION, messages
from sigmahat.live.events import Event
from sigmahat.live.jumps import Jumps
from sigmahat.live.live_joint import Estimated, News
from sigmahat.live.loop import Inbox, Loop, Message
from sigmahat.live.session import Session

LINK, MOTOR = "arm/link[0]", "arm/motor"


def sent(folder: Path, stream: list[dict[str, float | int]]) -> list[News]:
    (folder / "arm.toml").write_text(CONFIGURATION)
    news: list[News] = []
    loop = Loop(Session(folder / "arm.toml", folder), Inbox(lambda: 0.0), [news.extend])
    for each in stream:
        loop.take(Message(0, 0.0, each.copy))
    loop.end()
    return news


def events(news: list[News]) -> list[Event]:
    return [each for each in news if isinstance(each, Event)]


def test_stamps_that_repeat_are_said_at_once(tmp_path: Path) -> None:
    stream = messages(300)
    for each in stream:
        each["t"] = 0.005 * math.floor(each["t"] / 0.005 + 1e-6)
    news = sent(tmp_path, stream)
    (event,) = events(news)
    assert event.t < 0.3
    assert event.in_words.startswith("t: 60 of 100 messages have the time of the one before")


def test_another_unit_ends_the_confidence(tmp_path: Path) -> None:
    stream = messages(3000)
    for each in stream[2200:]:
        each[LINK] = math.radians(each[LINK])
    news = sent(tmp_path, stream)
    (event,) = events(news)
    assert event.shown()["port"] == "q"
    assert event.t == pytest.approx(4.4, abs=0.01)
    ticks = [each for each in news if isinstance(each, Estimated)]
    assert ticks[2190].outputs["confident"]
    assert not any(each.outputs["confident"] for each in ticks[2201:])
    assert ticks[-1].outputs["doubt"] == "PositionJumped"


def test_one_failed_reading_is_said_and_over(tmp_path: Path) -> None:
    stream = messages(2500)
    stream[2200][LINK] = -500.0
    news = sent(tmp_path, stream)
    assert [each.kind for each in events(news)] == ["position_jumped"]
    ticks = [each for each in news if isinstance(each, Estimated)]
    assert ticks[2200].outputs["doubt"] == "PositionJumped"
    assert ticks[2202].outputs["doubt"] != "PositionJumped"


@pytest.mark.parametrize("hold", [1, 25], ids=["smooth", "held"])
def test_no_motion_of_a_joint_is_a_jump(hold: int) -> None:
    jumps = Jumps(T=0.001)
    counts = 2 * math.pi / 48
    values = [round(math.sin(0.02 * (i // hold * hold)) / counts) * counts for i in range(2000)]
    assert not any(map(jumps.add, values))
