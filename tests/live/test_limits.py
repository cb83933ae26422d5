"""A limit of the stiffness, while the robot works."""

from pathlib import Path

import pytest

from command_line import Shell
from sender import CONFIGURATION, csv, messages
from sigmahat.live.events import Event, LimitPassed
from sigmahat.live.limits import Limits
from sigmahat.live.session import Session
from sigmahat.recording.log import LogError

SAMPLES = 10_000  # 20 s


def results(shell: Shell, count: int = 7) -> Path:
    """Results of some logs of the healthy joint."""
    Path("arm.toml").write_text(CONFIGURATION)
    for day in range(1, count + 1):
        log = Path(f"2026-03-0{day}.csv")
        log.write_text("\n".join(csv(messages(SAMPLES, seed=day))) + "\n")
        shell.run(f"estimate {log} --config arm.toml --out results/{day} --quiet")
    return Path("results")


def events(limits: Limits, factor: float) -> list[Event]:
    session = Session(Path("arm.toml"), Path(), limits=limits)
    sent = messages(SAMPLES, seed=20, changed=(0.0, factor))
    news = [new for each in sent for new in session.take(each, 0)]
    return [each for each in (*news, *session.close()) if isinstance(each, Event)]


@pytest.mark.slow("seven logs and three sessions")
def test_a_limit_that_is_passed_is_told_once(shell: Shell) -> None:
    limits = Limits.read(results(shell), -0.2)
    assert [each for each in events(limits, 1.0) if isinstance(each, LimitPassed)] == []
    (event,) = (each for each in events(limits, 0.6) if isinstance(each, LimitPassed))
    assert event.joint == "joint" and event.t >= 10.0 and event.probability > 0.95
    assert event.relative + 1 == pytest.approx(0.6, abs=event.half_width)
    assert "the limit of the stiffness, -20 %, is passed: -" in event.in_words
    assert event.shown()["kind"] == "limit_passed"


def test_too_few_results_and_other_joints_are_refused(shell: Shell) -> None:
    few = results(shell, 1)
    with pytest.raises(LogError, match="joint arm: expected results of 6 logs or more"):
        Limits.read(few, -0.2)
    with pytest.raises(LogError, match="joint 'leg' has no results for a limit"):
        Limits(-0.2, {}).of("leg", Path("leg.toml"))
    assert "--limit needs --health" in shell.refused("live arm.toml --limit stiffness=-10%")
