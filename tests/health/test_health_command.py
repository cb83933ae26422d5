"""`sigmahat health` as a user runs it."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import replace
from datetime import datetime, timezone
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from command_line import Shell
from joint_results import TrueJoint, changed, logs
from recorded_logs import REGRESSION, awas_log, write_log
from sigmahat.files.tables import read_csv
from sigmahat.health.logs import LogResult
from sigmahat.health.read import read_table, write_table
from sigmahat.recording.recorded import in_name

JOINT = TrueJoint()
SOFT = changed(JOINT, 40, 20, k=0.93 * JOINT.k)
UTC = timezone.utc


def with_digests(results: Sequence[LogResult]) -> list[LogResult]:
    return [
        replace(each, digests=[hashlib.sha256(d.encode()).hexdigest() for d in each.digests])
        for each in results
    ]


def table(results: Sequence[LogResult], folder: str = "results") -> Path:
    path = Path(folder, "results.jsonl")
    path.parent.mkdir(exist_ok=True)
    write_table(with_digests(results), path)
    return path


def test_a_table_is_read_as_it_was_written(shell: Shell) -> None:
    results = with_digests(logs([JOINT] * 3, seed=1))
    assert list(read_table(table(logs([JOINT] * 3, seed=1)))) == results


def test_a_line_for_each_joint_and_the_exit_status(shell: Shell) -> None:
    table([*logs([JOINT] * 60, 1, "hip"), *logs(SOFT, 2, "knee"), *logs([JOINT] * 3, 3, "toe")])
    lines = shell.run("health results", status=1).splitlines()
    assert lines[0].startswith("hip: unchanged since 2026-03-02 (")
    assert "N.m/rad, 60 logs), within +- 0." in lines[0]
    assert lines[1].startswith("knee: softer by ") and "% since about 2026-04-1" in lines[1]
    assert lines[2].startswith("toe: too few logs to tell (")
    out = Path("sigmahat-results", "health")
    made = {path.name for path in out.iterdir()}
    pictures = {f"{name}.{kind}" for name in ("hip", "knee", "toe") for kind in ("png", "svg")}
    assert made == {"health.html", "health.csv", "results.jsonl", *pictures}
    page = (out / "health.html").read_text()
    assert "knee: softer by" in page and "1 of 3 joints changed" in page
    rows = read_csv(out / "health.csv").to_pylist()
    assert {row["joint"] for row in rows} == {"hip", "knee", "toe"}
    (gain,) = [r for r in rows if (r["joint"], r["quantity"]) == ("hip", "gain of the torque")]
    assert gain["state"] == "unchanged"
    assert gain["change"].startswith("torque constant or current sensor: ")
    # THEN the table that it wrote gives the same answer
    assert shell.run(f"health {out} --out again", status=1).splitlines()[:3] == lines[:3]


def test_no_change_is_status_0_and_a_limit_that_is_passed_1(shell: Shell) -> None:
    table(logs([JOINT] * 60, 1))
    shell.run("health results --quiet")
    text = shell.run("health results --limit stiffness=-10%")
    assert "the limit of stiffness, -10 %, is passed with a probability of less than 1 %" in text
    table([*logs([JOINT] * 4, 2, "a"), *logs([replace(JOINT, gap=2e-4)] * 30, 3, "knee")])
    text = shell.run("health results --limit backlash=+0.1mrad --limit load=-99%")
    assert "backlash, +0.1 mrad" in text


def test_json_has_the_numbers(shell: Shell) -> None:
    table(logs(SOFT, 2))
    found = shell.json("health results --limit stiffness=-5%", status=1)
    knee = found["joints"]["knee"]
    assert found["alarm"] and knee["alarm"] and knee["gain_cancels"] and knee["logs"] == 60
    stiffness = knee["quantities"]["stiffness"]
    low, high = stiffness["change_interval"]
    assert low < -0.07 < high < -0.05
    assert stiffness["probability"] > 0.99 and stiffness["limit"] == -0.05
    (change,) = stiffness["changes"]
    assert change["kind"] == "step" and change["after"].startswith("2026-04-1")
    assert knee["quantities"]["coulomb"]["changes"] == []


def test_logs_before_a_repair_can_be_left_out(shell: Shell) -> None:
    table(logs(SOFT, 2))
    shell.run("health results", status=1)
    assert shell.json("health results --since 2026-04-12")["joints"]["knee"]["logs"] == 19


def test_a_possible_change_is_neither_an_alarm_nor_unchanged(shell: Shell) -> None:
    table(logs(changed(JOINT, 25, 5, k=0.96 * JOINT.k), 19))
    line = shell.run("health results --false-alarms 1e-6").splitlines()[0]
    assert line.startswith("knee: perhaps softer by ") and "unchanged" not in line
    assert "% since about 2026-03-2" in line and ": more logs will tell (38" in line
    page = Path("sigmahat-results", "health", "health.html").read_text()
    assert "perhaps a change in 1 of 1 joints" in page and "no change" not in page
    command = "health results --false-alarms 1e-6 --limit stiffness=-1%"
    line = shell.run(command, status=1).splitlines()[0]
    assert "perhaps softer" in line and "is passed with a probability of" in line
    page = Path("sigmahat-results", "health", "health.html").read_text()
    assert "1 of 1 joints changed, or likely passed a limit" in page
    knee = shell.json("health results --false-alarms 1e-6")["joints"]["knee"]
    assert (knee["state"], knee["alarm"]) == ("perhaps changed", False)


def test_logs_that_do_not_reach_the_deformations_are_counted_and_named(shell: Shell) -> None:
    results = logs([JOINT] * 30, 1)
    for i in (3, 7):
        told = results[i].together
        narrow = replace(told, phi=[0.5 * x for x in told.phi])
        results[i] = replace(results[i], together=narrow)
    table(results)
    text = shell.run("health results")
    note = (
        "knee: 2 of 30 logs do not count for the stiffness: knee/3 and 1 more, which do not reach "
        "the agreed deformations (-8 to 8 mrad)"
    )
    assert "N.m/rad, 28 of 30 logs)" in text.splitlines()[0] and note in text.splitlines()
    assert shell.json("health results")["joints"]["knee"]["left_out"] == [note]


def test_friction_that_is_unchanged_says_nothing_of_a_stiffness_of_few_logs(shell: Shell) -> None:
    results = logs([JOINT] * 30, 1)
    for i in range(5, 30):
        told = results[i].together
        negative = [-x for x in told.values[:5]] + told.values[5:]
        results[i] = replace(results[i], together=replace(told, values=negative))
    table(results)
    line = shell.run("health results --limit stiffness=-10%").splitlines()[0]
    assert line.startswith("knee: the stiffness cannot be judged: 5 of 30 logs count (")
    assert "6 are needed; what else the logs show is unchanged since 2026-03-02" in line
    assert "; the last 25 logs do not count for the stiffness" in line
    assert "the limit of stiffness, -10 %, cannot be judged: only 5 of the 6 logs" in line


def test_unchanged_does_not_stand_for_what_the_logs_would_not_show(shell: Shell) -> None:
    """Nor are a few logs of many enough, nor results that scatter by as much as would matter."""
    results = logs([JOINT] * 30, 1)

    def with_values(day: int, factor: float) -> LogResult:
        told = results[day].together
        values = [factor * x for x in told.values[:5]] + told.values[5:]
        return replace(results[day], together=replace(told, values=values))

    def first_line(some: Sequence[LogResult]) -> str:
        table(some)
        return shell.run("health results").splitlines()[0]

    few = [with_values(day, -1.0) if day % 3 < 2 else results[day] for day in range(30)]
    line = first_line(few)
    assert line.startswith("knee: the stiffness cannot be judged: 10 of 30 logs count (")
    assert "its change is known within +- " in line
    found = shell.json("health results")["joints"]["knee"]
    assert (found["state"], found["alarm"], found["watched"]) == ("cannot be judged", False, False)
    page = Path("sigmahat-results", "health", "health.html").read_text()
    assert "1 of 1 cannot be judged, or not by the last logs" in page
    rng = np.random.default_rng(2)
    wild = [with_values(day, float(np.exp(0.3 * rng.standard_normal()))) for day in range(30)]
    line = first_line(wild)
    assert line.startswith("knee: the stiffness cannot be judged: 30 logs count (")


def test_new_logs_that_do_not_count_are_told(
    shell: Shell, caplog: pytest.LogCaptureFixture
) -> None:
    """Also by a warning: a job of each night would be silent otherwise. Two may be bad ones."""
    results = logs([JOINT] * 30, 1)
    words = "the last {} logs do not count for the stiffness"
    for count, is_told in ((2, False), (3, True)):
        doubtful = [replace(each, doubt="NegativeStiffness") for each in results[-count:]]
        table([*results[:-count], *doubtful])
        line = shell.run("health results").splitlines()[0]
        assert (words.format(count) in line) == is_told
        warned = ["a change of the stiffness would not be seen: knee"] if is_told else []
        assert caplog.messages == warned


def test_an_answer_without_a_log_is_an_error(shell: Shell) -> None:
    results = logs([JOINT] * 3, 1)
    table(results)
    assert (
        "--since 2026-04-01: expected a day before the last log, of 2026-03-04; no log is left"
        in shell.refused("health results --since 2026-04-01")
    )
    table([replace(each, doubt="NegativeStiffness") for each in results])
    line = shell.refused("health results")
    assert "no result counts: knee/0: left out, NegativeStiffness" in line


def test_a_limit_that_cannot_be_judged_is_told(shell: Shell) -> None:
    table(logs([JOINT] * 30, 1))
    words = "the limit of backlash, +0.5 mrad, cannot be judged: no log shows any backlash"
    assert words in shell.run("health results --limit backlash=+0.5mrad").splitlines()[0]
    found = shell.json("health results --limit backlash=+0.5mrad")["joints"]["knee"]
    assert found["limits_not_judged"] == {"backlash": "no log shows any backlash"}


def test_data_sheets_that_cannot_be_read_are_named_and_the_rest_is_judged(shell: Shell) -> None:
    table(logs([JOINT] * 30, 1))
    old = '{"format": "sigmahat joint data sheet", "version": 1}'
    for name, text in (("old", old), ("broken", "{")):
        Path("results", name).mkdir()
        Path("results", name, "joint.json").write_text(text)
    text = shell.run("health results")
    assert "knee: unchanged since" in text and "30 logs), within" in text
    assert "left out: results/old/joint.json: expected version 2 of the format, got 1" in text
    assert "left out: results/broken/joint.json: expected" in text
    assert len(shell.json("health results")["notes"]) == 2
    Path("results", "results.jsonl").unlink()
    assert "(and 1 more files)" in shell.refused("health results")
    assert "expected version 2" in shell.refused("health results/old/joint.json")


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ("none", "none: No such file or directory; name the folder"),
        ("empty", "empty: expected results of `sigmahat estimate` (joint.json) or a table"),
        ("results --limit stiffness=10", "expected stiffness=-10%, backlash=+0.5mrad"),
        (
            "results --limit stiffness=-5",
            "got 'stiffness=-5', without %: did you mean stiffness=-5%?",
        ),
        ("results --limit backlash=0.5", "without mrad: did you mean backlash=0.5mrad?"),
        ("results --limit spring=-10%", "expected stiffness=-10%"),
        ("results --limit stiffness=0%", "expected stiffness=-10%"),
        ("results --limit stiffness=nan%", "expected stiffness=-10%"),
        ("results --limit stiffness=-100%", "expected a change above -100 %"),
        ("results --limit load=-5% --limit load=-6%", "expected one limit for load, got 2"),
        ("future", "line 1.time: expected a time of the recording from 1990 until now, got 2126"),
        ("early", "line 1.time: expected a time of the recording from 1990 until now, got 1970"),
        ("negative", "expected a covariance that is symmetric and positive semi-definite"),
        ("indefinite", "expected a covariance that is symmetric and positive semi-definite"),
        ("skew", "expected a covariance that is symmetric and positive semi-definite"),
        ("nan", "line 1.together.covariance.0.0: Input should be a finite number"),
        ("other", "expected one or more points, and the quantities B, D_theta"),
        ("prior", "line 1.together.prior.B.std: Input should be greater than or equal to 0"),
        ("results --false-alarms 0", "0.0 is not in the range"),
        ("broken", "broken/results.jsonl: line 2: expected JSON, got '{broken'"),
        ("hostile", "expected the name of a joint"),
        ("wrong", "line 1.together: expected a covariance of 11 x 11 numbers"),
        ("naive", "line 1.time: Input should have timezone info"),
        ("old", "expected version 2 of the format, got 1; run `sigmahat estimate` again"),
    ],
)
def test_what_does_not_fit_is_refused_in_one_line(arguments: str, words: str, shell: Shell) -> None:
    path = table(logs([JOINT] * 3, 1))
    line = path.read_text().splitlines()[0]
    values: dict[str, Any] = json.loads(line)
    Path("empty").mkdir()
    others = {
        "broken": f"{line}\n{{broken\n",
        "hostile": json.dumps({**values, "joint": "=cmd|' /C calc'!A0"}),
        "wrong": json.dumps({**values, "together": {**values["together"], "covariance": [[1.0]]}}),
        "naive": json.dumps({**values, "time": "2026-03-02T08:00:00"}),
    }
    others |= {
        "future": json.dumps({**values, "time": "2126-03-02T08:00:00Z"}),
        "early": json.dumps({**values, "time": "1970-03-02T08:00:00Z"}),
    }
    for name, changes in (
        ("negative", {(5, 5): -1e-12}),
        ("indefinite", {(5, 6): 1.0, (6, 5): 1.0}),
        ("skew", {(0, 1): 0.0}),
        ("nan", {(0, 0): np.nan}),
    ):
        P = np.array(values["together"]["covariance"])
        for place, value in changes.items():
            P[place] = value
        others[name] = json.dumps(
            {**values, "together": {**values["together"], "covariance": P.tolist()}}
        )
    others["other"] = line.replace('"D_theta","tau', '"D","tau')
    others["prior"] = line.replace('"std":0.0001}', '"std":-1.0}')
    for name, text in others.items():
        Path(name).mkdir()
        Path(name, "results.jsonl").write_text(text)
    Path("old").mkdir()
    Path("old", "joint.json").write_text('{"format": "sigmahat joint data sheet", "version": 1}')
    assert words in shell.refused(f"health {arguments}")


def test_a_data_sheet_with_an_impossible_time_is_left_out(shell: Shell) -> None:
    write_log(awas_log(1.0, 0.3, 3.0), Path("2090-03-02.parquet"), REGRESSION)
    shell.run("estimate 2090-03-02.parquet --out out --quiet")
    table(logs([JOINT] * 6, 1))
    text = shell.run("health results out --out health")
    assert "left out: out/joint.json: expected a time of the recording from 1990 until now" in text
    line = shell.refused("estimate 2090-03-02.parquet --out out --recorded 1989-12-31")
    assert "from 1990 until now, got 1989-12-31T00:00 (UTC)" in line


def test_a_hostile_place_is_text_in_the_page(shell: Shell) -> None:
    results = logs([JOINT] * 10, 1)
    place = "<script>alert('pwned')</script>"
    bad = replace(results[3], place=place, doubt="NegativeStiffness", digests=["x"])
    table([*results, bad])
    shell.run("health results --out out")
    page = Path("out", "health.html").read_text()
    assert place not in page and "&lt;script&gt;alert" in page


@pytest.mark.parametrize(
    ("name", "time"),
    [
        ("knee 2026-03-02", datetime(2026, 3, 2, tzinfo=UTC)),
        ("2026-03-02T08-15-30-123456", datetime(2026, 3, 2, 8, 15, 30, tzinfo=UTC)),
        ("rosbag2_2026_03_02-08_15_30", datetime(2026, 3, 2, 8, 15, 30, tzinfo=UTC)),
        ("20260302_0815", datetime(2026, 3, 2, 8, 15, tzinfo=UTC)),
        ("20260302", datetime(2026, 3, 2, tzinfo=UTC)),
        ("fw2025-11-07_2026-03-02", None),  # which of them?
        ("SN20251107_2026-03-02", None),
        ("2026-03-02_20260302_0815", datetime(2026, 3, 2, tzinfo=UTC)),
        ("20260302_202603", datetime(2026, 3, 2, 20, 26, 3, tzinfo=UTC)),
        ("2026-02-30", None),
        ("120260302", None),
        ("knee 12", None),
    ],
)
def test_a_date_in_the_name_of_a_log(name: str, time: datetime | None) -> None:
    assert in_name(name) == time


def test_the_time_of_a_recording(shell: Shell) -> None:
    """By the clock of the log, in its name, given, or asked for."""
    log, T = awas_log(1.0, 0.3, 3.0), 1e-3
    since = {**log, "t": 1.7727e9 + T * np.arange(len(log["t"]))}
    regression = REGRESSION
    write_log(since, Path("clock.parquet"), regression)
    write_log(log, Path("2026-03-02.parquet"), regression)
    write_log(log, Path("knee.parquet"), regression)
    times = {}
    for name, option in (("clock", ""), ("2026-03-02", ""), ("knee", ""), ("given", "--recorded")):
        of, more = ("knee", f"{option} 2026-03-05T12:00") if option else (name, "")
        shell.run(f"estimate {of}.parquet --out out/{name} {more} --quiet")
        sheet = json.loads(Path("out", name, "joint.json").read_text())
        times[name] = (sheet["recorded"]["time"], sheet["recorded"]["source"])
        assert sheet["excitation"]["velocity"] > 0
    assert times == {
        "clock": (datetime.fromtimestamp(1.7727e9, UTC).isoformat(), "log"),
        "2026-03-02": ("2026-03-02T00:00:00+00:00", "name"),
        "knee": (None, "unknown"),
        "given": ("2026-03-05T12:00:00+00:00", "given"),
    }
    text = shell.run("health out --out health")
    assert "when was the log of out/knee/joint.json recorded?" in text
    assert "--recorded 2026-03-02T08:15" in text
    # The log without a time is the one that was given a time: it counts once, as 2026-03-02 does.
    assert text.startswith("out: too few logs to tell (")


def two_logs() -> None:
    """Logs of two days, and their configuration."""
    Path("logs").mkdir()
    for day in (1, 2):
        write_log(awas_log(1.0, 0.3, 3.0, seed=day), Path("logs", f"2026-03-0{day}.parquet"))
    Path("knee.toml").write_text(REGRESSION)


def test_logs_are_estimated_once(shell: Shell) -> None:
    """Each night, only the new logs of a folder are estimated."""
    two_logs()
    command = "health logs --config knee.toml --out out"
    assert shell.run(command).startswith("knee: too few logs to tell (")
    sheets = sorted(Path("out", "logs").rglob("joint.json"))
    assert [path.parent.name for path in sheets] == ["2026-03-01", "2026-03-02"]
    times = [path.stat().st_mtime_ns for path in sheets]
    write_log(awas_log(1.0, 0.3, 3.0, seed=3), Path("logs", "2026-03-03.parquet"))
    assert "3 logs; 6 are needed)" in shell.run(command)
    assert [path.stat().st_mtime_ns for path in sheets] == times
    sheets[0].write_text("{")  # a damaged result is made again
    assert "3 logs; 6 are needed)" in shell.run(command)
    assert "expected logs (" in shell.refused("health out/logs --config knee.toml")


def test_a_log_that_cannot_be_estimated_does_not_stop_the_night(shell: Shell) -> None:
    """Such as one of a recording that was cut off at once; the others are judged."""
    two_logs()
    Path("logs", "2026-03-03.csv").write_text("")
    Path("logs", "2026-03-04.csv").write_text("t,other\n0,1\n0.001,1\n")
    command = "health logs --config knee.toml --out out"
    for _ in range(2):
        text = shell.run(command)
        assert "2 logs; 6 are needed)" in text
        assert (
            "left out: logs/2026-03-03.csv: " in text and "left out: logs/2026-03-04.csv: " in text
        )
        found = shell.json(command)
        assert len(found["notes"]) == 2
        # THEN they count as logs that show nothing: after three in a row, a warning says so.
        assert found["joints"]["knee"]["last_logs_not_counted"] == 2
    for name in ("01", "02"):
        Path("logs", f"2026-03-{name}.parquet").unlink()
    # Their results are left, so something is judged; without them, nothing is.
    shell.run(command)
    line = shell.refused("health logs --config knee.toml --out none")
    assert "no log can be estimated: left out: logs/2026-03-03.csv: " in line
    Path("knee.toml").write_text(REGRESSION.replace("[ports.q]", "[ports.other]"))
    assert "knee.toml: " in shell.refused(command) and "left out" not in shell.refused(command)


def test_another_configuration_estimates_the_logs_again(shell: Shell) -> None:
    """Else its change would be one of the joint. A log that is gone has its result, with a note."""
    two_logs()
    command = "health logs --config knee.toml --out out"
    shell.run(command)
    first, second = sorted(Path("out", "logs").rglob("joint.json"))
    times = [path.stat().st_mtime_ns for path in (first, second)]
    Path("knee.toml").write_text(f"{REGRESSION}\n# another one\n")
    Path("logs", "2026-03-02.parquet").unlink()
    text = shell.run(command)
    assert first.stat().st_mtime_ns > times[0] and second.stat().st_mtime_ns == times[1]
    assert "1 results in out/logs/logs are of another configuration than knee.toml" in text


def test_the_example_shows_what_its_page_says(shell: Shell) -> None:
    repository = Path(__file__).parents[2]
    page = (repository / "docs" / "how-to" / "health.md").read_text()
    command = f"health {repository / 'examples' / 'health'} --limit stiffness=-10%"
    line = shell.run(command, status=1).splitlines()[0]
    assert line in page
