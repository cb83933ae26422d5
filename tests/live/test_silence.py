"""What live says when data stop, with a clock that the test moves."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from sender import CONFIGURATION, T, messages, of_joints
from sigmahat.live.events import Event
from sigmahat.live.live_joint import Estimated, News
from sigmahat.live.loop import Inbox, Loop, Message, receive
from sigmahat.live.session import Session

LINK = "arm/link[0]"


class Stream:
    """The loop with a session, whose messages arrive when the test says so."""

    def __init__(self, folder: Path, text: str = CONFIGURATION) -> None:
        (folder / "arm.toml").write_text(text)
        self.now = 0.0
        self.news: list[News] = []
        self.session = Session(folder / "arm.toml", folder)
        self.inbox = Inbox(lambda: self.now)
        self.loop = Loop(self.session, self.inbox, [self.news.extend])

    def send(self, sent: Sequence[Mapping[str, float]], at: float, period: float = T) -> None:
        """Messages arrive a period apart, the first one at a time [s]."""
        for i, each in enumerate(sent):
            self.pass_until(at + i * period)
            self.loop.take(Message(round(1e9 * self.now), self.now, partial(dict, each)))

    def pass_until(self, t: float) -> None:
        while self.now + 0.1 < t:
            self.now += 0.1
            self.loop.wait()
        self.now = t

    @property
    def events(self) -> list[Event]:
        return [each for each in self.news if isinstance(each, Event)]

    @property
    def kinds(self) -> list[str]:
        return [each.kind for each in self.events]

    def last(self, joint: str = "joint") -> Estimated:
        ticks = [each for each in self.news if isinstance(each, Estimated)]
        return [each for each in ticks if each.joint == joint][-1]

    def close(self) -> None:
        self.loop.end()


@pytest.fixture
def stream(tmp_path: Path) -> Iterator[Callable[..., Stream]]:
    opened: list[Stream] = []

    def begin(text: str = CONFIGURATION) -> Stream:
        opened.append(Stream(tmp_path, text))
        return opened[-1]

    yield begin
    for each in opened:
        each.close()


def test_silence_ends_the_confidence(stream: Callable[..., Stream]) -> None:
    robot = stream()
    robot.send(messages(2000), 0.0)
    before = robot.last()
    assert before.in_words == "confident" and before.data_age == 0
    robot.pass_until(4.4)  # 0.4 s
    assert robot.last() is before and robot.events == []
    robot.pass_until(7.05)
    silent = robot.last()
    assert silent.in_words == "no data for 3 s"
    shown = silent.shown()
    assert (shown["confident"], shown["valid"], shown["doubt"]) == (False, False, "NoData")
    assert shown["data_age"] == pytest.approx(3.0, abs=0.3)
    assert silent.t == pytest.approx(7.0, abs=0.3)
    assert shown["sigma"] == before.outputs["sigma"]
    (event,) = robot.events
    assert event.in_words == "no data for 0.5 s; does the sender run?"
    assert event.t == pytest.approx(4.5, abs=0.11)


def test_data_that_come_back_are_said_once(stream: Callable[..., Stream]) -> None:
    robot = stream()
    sent = messages(4000)
    robot.send(sent[:2000], 0.0)
    robot.send(sent[2400:], 4.8)
    assert robot.kinds == ["no_data", "data_again"]
    assert robot.events[-1].in_words == "data again, after 0.8 s without"
    assert robot.last().in_words == "confident" and robot.last().data_age == 0


def test_slow_messages_have_three_periods(stream: Callable[..., Stream]) -> None:
    robot = stream()
    sent = messages(4000)[::200]  # 0.4 s apart
    robot.send(sent, 0.0, 200 * T)
    assert robot.kinds == []
    last = robot.now
    robot.pass_until(last + 1.1)
    assert robot.kinds == []
    robot.pass_until(last + 1.4)
    assert robot.kinds == ["no_data"]


def test_a_sender_that_becomes_slower_is_silent_once(stream: Callable[..., Stream]) -> None:
    robot = stream()
    sent = messages(6000)
    robot.send(sent[:2000], 0.0)
    robot.send(sent[2000::400], 4.0 + 400 * T, 400 * T)
    assert robot.kinds.count("no_data") <= 1


def test_nothing_at_all(stream: Callable[..., Stream]) -> None:
    robot = stream()
    robot.pass_until(20.0)
    (event,) = robot.events
    assert event.in_words == "no data for 5 s; does the sender run?"


@pytest.mark.parametrize("how", ["absent", "nan"])
def test_a_field_that_disappears_is_named_once(how: str, stream: Callable[..., Stream]) -> None:
    robot = stream()
    sent = messages(4000)
    for each in sent[2000:3000]:
        if how == "absent":
            del each[LINK]
        else:
            each[LINK] = float("nan")
    robot.send(sent[:2300], 0.0)
    (event,) = robot.events
    assert event.in_words == "no 'arm/link[0]' for 0.5 s, while messages arrive"
    assert event.t == pytest.approx(4.5, abs=0.05)
    robot.send(sent[2300:3000], 4.6)
    assert robot.last().in_words == "no data for 2 s"
    robot.send(sent[3000:], 6.0)
    assert robot.kinds == ["fields_missing", "fields_again"]
    assert robot.events[-1].in_words == "'arm/link[0]' again"
    assert robot.last().in_words == "confident"


def test_the_end_of_a_stream_without_a_field_is_not_confident(
    stream: Callable[..., Stream],
) -> None:
    robot = stream()
    sent = messages(3000)
    for each in sent[2000:]:
        del each[LINK]
    robot.send(sent, 0.0)
    robot.close()
    assert robot.last().in_words == "no data for 2 s"
    assert robot.kinds == ["fields_missing"]


def test_a_field_that_never_comes(stream: Callable[..., Stream]) -> None:
    robot = stream()
    sent = messages(1000)
    for each in sent:
        del each[LINK]
    robot.send(sent, 0.0)
    (event,) = robot.events
    expected = "none of 100 messages has 'arm/link[0]', which the configuration names"
    assert event.in_words == expected


def test_the_time_that_disappears(stream: Callable[..., Stream]) -> None:
    robot = stream()
    sent = messages(3000)
    for each in sent[2000:]:
        del each["t"]
    robot.send(sent, 0.0)
    (event,) = robot.events
    assert "no 't' for 0.5 s" in event.in_words
    assert robot.last().outputs["doubt"] == "NoData"


def test_silence_is_not_a_missing_field(stream: Callable[..., Stream]) -> None:
    """After a silence, a topic that comes less often has its time again."""
    text = CONFIGURATION.replace('"arm/link[0]"', '"arm/link[0]"\ntime = "t_link"')
    robot = stream(text.replace('column = "t"', 'column = "t"\nlongest_gap = 0.25'))
    sent: list[dict[str, Any]] = []
    for i, each in enumerate(messages(4000)):
        link = {"t_link": each["t"], LINK: each.pop(LINK)}
        sent.append({**each, **(link if i % 100 == 0 else {})})
    robot.send(sent[:2000], 0.0)
    robot.send(sent[2350:], 4.7)
    assert robot.kinds == ["no_data", "data_again"]


def test_one_joint_of_two(stream: Callable[..., Stream]) -> None:
    names = ["elbow", "wrist"]
    robot = stream(of_joints(names, [f"{name}/" for name in names]))
    sent: list[dict[str, float]] = []
    for i, each in enumerate(messages(3000)):
        alive = names if i < 1500 else ["elbow"]
        sent.append({k.replace("arm/", f"{n}/"): v for n in alive for k, v in each.items()})
    robot.send(sent, 0.0)
    (event,) = robot.events
    fields = "'wrist/motor', 'wrist/link[0]', 'wrist/torque'"
    assert event.in_words == f"no {fields} for 0.5 s, while messages arrive"
    assert robot.last("elbow").in_words == "confident"
    assert robot.last("wrist").in_words == "no data for 3 s"


@pytest.mark.parametrize(
    ("pause", "begin", "expected"),
    [
        (0.0, 0.0, "the sender has started again: its time jumped by -4.0 s to 0.0 s"),
        (9.0, 0.0, "the sender has started again: its time jumped by -4.0 s to 0.0 s"),
        (9.0, 13.0, "the sender has paused, or started again: its time jumped by +9.0 s to 13.0"),
    ],
)
def test_a_restart_is_one_line(
    pause: float, begin: float, expected: str, stream: Callable[..., Stream]
) -> None:
    robot = stream()
    robot.send(messages(2000), 0.0)
    again = [{**each, "t": each["t"] + begin} for each in messages(2000)]
    robot.send(again, 4.0 + pause)
    assert robot.kinds == (["no_data"] if pause else []) + ["sender_restarted"]
    assert expected in robot.events[-1].in_words
    assert robot.last().in_words == "confident"


@pytest.mark.parametrize("factor", [0.7, 1.6])
def test_a_change_is_an_event_with_its_size(factor: float, stream: Callable[..., Stream]) -> None:
    robot = stream()
    robot.send(messages(10_000, changed=(10.0, factor)), 0.0)
    detected, sized = robot.events
    assert detected.kind == sized.kind == "stiffness_changed"
    changed, size = detected.shown(), sized.shown()
    assert changed["joint"] == "joint"
    assert changed["relative"] is None
    assert 10.0 < changed["changed_at"] < 12.0
    assert size["changed_at"] == changed["changed_at"] <= size["t"]
    assert size["relative"] == pytest.approx(factor - 1, abs=0.05)
    assert size["text"].startswith("joint: the stiffness changed by ")


def test_a_message_that_cannot_be_read_is_said_once(stream: Callable[..., Stream]) -> None:
    robot = stream()

    def read() -> None:
        raise ValueError("expected JSON")

    for _ in range(3):
        robot.loop.take(Message(0, 0.0, read))
    assert robot.inbox.wrong == 3
    (event,) = robot.events
    assert event.in_words == "a message that cannot be read: expected JSON; more are counted"


@pytest.mark.parametrize("failure", [None, OSError(24, "Too many open files")])
def test_a_source_that_ends_ends_the_loop(failure: OSError | None) -> None:
    def source(inbox: Inbox) -> None:
        if failure is not None:
            raise failure

    inbox = Inbox()
    receive(source, inbox)
    with pytest.raises(EOFError):
        inbox.get_nowait().read()
    assert inbox.failure is failure
