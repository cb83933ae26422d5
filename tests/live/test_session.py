"""The estimates on line equal the results of `estimate` from the recording, to the last bit."""

import json
import math
import tempfile
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from command_line import working_in
from sender import CONFIGURATION, COUNTS, T, estimated, messages, of_joints
from sigmahat.live.live_joint import OUTPUTS, Estimated, News
from sigmahat.live.messages import Columns
from sigmahat.live.session import Session
from sigmahat.recording.configuration import read_configuration
from sigmahat.recording.readers.formats import open_log
from sigmahat.result.estimate import estimate

SECOND = 1_000_000_000


def live(
    folder: Path,
    sent: Sequence[Columns],
    text: str = CONFIGURATION,
    start: Path | None = None,
    arrived: Callable[[int], int] = lambda number: 0,
) -> tuple[Session, list[Estimated]]:
    """Everything goes through a session; message of each number arrives at [ns]."""
    config, out = folder / "arm.toml", folder / "out"
    out.mkdir(parents=True, exist_ok=True)
    config.write_text(text)
    session = Session(config, out, start)
    news = [new for i, each in enumerate(sent) for new in session.take(each, arrived(i))]
    return session, estimates([*news, *session.close()])


def estimates(news: Sequence[News]) -> list[Estimated]:
    return [each for each in news if isinstance(each, Estimated)]


def same(ticks: Sequence[Estimated], series: Any) -> None:
    for name in (*OUTPUTS, "confident", "valid", "doubt"):
        np.testing.assert_array_equal([each.outputs[name] for each in ticks], series[name], name)


@st.composite
def disturbed(draw: st.DrawFn) -> list[dict[str, Any]]:
    """Messages that were late, lost, doubled or moved in time, with values that are missing."""
    found = messages(draw(st.integers(300, 600)), draw(st.integers(0, 9)))
    for each in found:
        each["t"] += draw(st.sampled_from([0.0, 0.0, 0.0, 3e-7, 4e-4, -4e-4]))
    for _ in range(draw(st.integers(0, 12))):
        place = draw(st.integers(1, len(found) - 5))
        what = draw(st.sampled_from(["lose", "double", "swap", "nan", "absent", "no stamp", "far"]))
        match what:
            case "lose":
                del found[place : place + draw(st.sampled_from([1, 2, 3, 4, 80]))]
            case "double":
                found.insert(place, dict(found[place - 1]))
            case "swap":
                found[place], found[place + 1] = found[place + 1], found[place]
            case "nan":
                for each in found[place : place + draw(st.sampled_from([1, 3, 150]))]:
                    each["arm/link[0]"] = math.nan
            case "absent":
                found[place].pop("arm/torque", None)
            case "no stamp":
                found[place].pop("t", None)
            case "far":
                t = draw(st.sampled_from([-50.0, 900.0, 1e300]))
                found.insert(place, {**found[place], "t": t})
    return found


@settings(max_examples=30, deadline=None)
@given(
    sent=disturbed(), offset=st.sampled_from([0, 1_700_000_000]), delay=st.sampled_from([0, 3e-3])
)
def test_live_is_bit_identical_to_estimate(
    sent: list[dict[str, Any]], offset: int, delay: float
) -> None:
    text = CONFIGURATION.replace("zero = 2.5", f"zero = 2.5\ndelay = {delay}")
    for each in sent:
        if "t" in each:
            each["t"] += offset
    with tempfile.TemporaryDirectory() as folder:
        session, ticks = live(Path(folder), sent, text)
        (recording,) = session.recordings
        same(ticks, estimated(recording))


def test_times_in_nanoseconds_are_not_rounded(tmp_path: Path) -> None:
    sent = messages(1000)
    for each in sent:
        each["t"] = 1_700_000_000 * SECOND + round(each["t"] * SECOND)
    text = CONFIGURATION.replace('column = "t"', 'column = "t"\nunit = "ns"')
    session, ticks = live(tmp_path, sent, text)
    assert sum(port.interpolated for joint in session.joints for port in joint.ports.values()) == 0
    assert ticks[-1].t == pytest.approx(1_700_000_000 + 999 * T, abs=1e-6)
    same(ticks, estimated(session.recordings[0]))


def test_without_stamps_the_time_of_arrival_counts(tmp_path: Path) -> None:
    def arrived(i: int) -> int:
        return 1_700_000_000 * SECOND + round(i * T * SECOND) + 50_000 * (i % 3)

    sent = [{name: x for name, x in each.items() if name != "t"} for each in messages(500)]
    text = CONFIGURATION.replace('column = "t"', "")
    session, ticks = live(tmp_path, sent, text, arrived=arrived)
    assert len(ticks) == 500
    same(ticks, estimated(session.recordings[0]))


@pytest.mark.parametrize("replaced", ["theta", "q"])
def test_a_deformation_takes_the_place_of_a_position(replaced: str, tmp_path: Path) -> None:
    sent = messages(600)
    t = T * np.arange(len(sent))
    phi = 0.03 * np.sin(5 * t) + 0.02 * np.sin(13 * t)
    for each, deformation in zip(sent, np.degrees(phi).tolist(), strict=True):
        each["arm/spring"] = deformation
    start = CONFIGURATION.index(f"[ports.{replaced}]")
    section = CONFIGURATION[start : CONFIGURATION.index("[ports", start + 1)]
    text = CONFIGURATION.replace(section, '[ports.phi]\ncolumn = "arm/spring"\nunit = "deg"\n')
    session, ticks = live(tmp_path, sent, text)
    np.testing.assert_allclose([each.outputs["phi"] for each in ticks], phi, atol=1e-12)
    same(ticks, estimated(session.recordings[0]))


def two_topics() -> Iterator[dict[str, float]]:
    """The link comes in messages of its own, half as often, and a little later."""
    for i, each in enumerate(messages(1000)):
        link = {"t_link": each["t"] + 7e-4, "arm/link[0]": each.pop("arm/link[0]")}
        yield from [each, link] if i % 2 == 0 else [each]


TWO_TOPICS = CONFIGURATION.replace('"arm/link[0]"', '"arm/link[0]"\ntime = "t_link"')
TWO_TOPICS = TWO_TOPICS.replace('column = "t"', 'column = "t"\nlongest_gap = 0.013')


def test_ports_with_times_of_their_own(tmp_path: Path) -> None:
    session, ticks = live(tmp_path, list(two_topics()), TWO_TOPICS)
    assert np.mean([each.outputs["valid"] for each in ticks]) > 0.99
    same(ticks, estimated(session.recordings[0]))


def test_a_topic_that_dies_does_not_stop_the_others(tmp_path: Path) -> None:
    sent = [
        each for i, each in enumerate(two_topics()) if "t_link" not in each or not 300 < i < 900
    ]
    config = tmp_path / "arm.toml"
    config.write_text(TWO_TOPICS)
    session = Session(config, tmp_path)
    waited = 0.0
    ticks: list[Estimated] = []
    for each in sent:
        ticks += estimates(session.take(each, 0))
        if ticks and "t" in each:
            waited = max(waited, each["t"] - ticks[-1].t)
    ticks += estimates(session.close())
    assert 0.1 < waited < 0.3
    assert len(ticks) == 1000
    same(ticks, estimated(session.recordings[0]))


@pytest.mark.parametrize("again_at", [-3.0, 0.0, 60.0])
def test_a_sender_that_starts_again_is_noticed(again_at: float, tmp_path: Path) -> None:
    """The sender begins another recording, with which the estimator goes on."""
    first, second = messages(1000, 1), messages(1000, 2)
    for each in second:
        each["t"] += again_at
        each["arm/motor"] = (each["arm/motor"] + 1234) % COUNTS  # of another turn
    session, ticks = live(tmp_path, [*first, *second])
    one, two = session.recordings
    same(ticks[:1000], estimated(one))
    with working_in(tmp_path):
        estimate(open_log(one), read_configuration(one.with_suffix(".toml")), tmp_path)
    same(ticks[1000:], estimated(two, start=tmp_path))


def test_what_was_learned_goes_on(tmp_path: Path) -> None:
    sent = messages(6000)
    live(tmp_path, sent[:3000])
    _, ticks = live(tmp_path, sent[3000:], start=tmp_path / "out")
    state = json.loads((tmp_path / "out" / "state.json").read_text())
    assert [each["ticks"] for each in state["logs"]] == [3000, 3000]
    assert ticks[0].outputs["confident"]
    assert [each.outputs["sigma"] for each in ticks] == pytest.approx([400] * 3000, rel=0.05)


def test_many_joints_in_one_message(tmp_path: Path) -> None:
    """The result of each joint is as if it were alone."""
    names = [f"a{i}" for i in range(1, 8)]
    several = of_joints(names, [f"{name}/" for name in names])
    each_joint = [messages(400, seed) for seed in range(7)]
    sent: list[dict[str, Any]] = [{} for _ in range(400)]
    for name, alone in zip(names, each_joint, strict=True):
        for message, of_one in zip(sent, alone, strict=True):
            message |= {key.replace("arm/", f"{name}/"): v for key, v in of_one.items()}
    session, ticks = live(tmp_path, sent, several)
    (recording,) = session.recordings
    for place, name in enumerate(names):
        own = [each for each in ticks if each.joint == name]
        _, expected = live(tmp_path / name, each_joint[place])
        assert [each.outputs for each in own] == [each.outputs for each in expected]
        same(own, estimated(recording, joint=name))
        assert (tmp_path / "out" / name / "state.json").is_file()
