"""Results of logs: which belong to one joint, in the order of time, and which are evidence."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import datetime
from enum import Enum

from sigmahat.result.excitation import Excitation
from sigmahat.result.sheet import Together


@dataclass(frozen=True)
class LogResult:
    """What `estimate` found in one log of a joint."""

    joint: str
    time: datetime  # of the recording, with a time zone
    place: str  # file of the result, or row of a table, for messages
    digests: Sequence[str]
    """SHA-256 of the logs that the estimator has processed; the last is the log of this result."""
    together: Together
    excitation: Excitation
    torque_gain: float  # relative standard deviation of the gain of the torque [1]
    doubt: str  # item of the output `doubt` at the end; "None": the estimator was confident
    temperature: float | None = None  # mean over the log [degC]


_USABLE = ("None", "NotExcited", "Misfit")
"""Items of `doubt` with which a result counts: its standard deviation is large, but holds. The
others say that it is wrong, or that it changed within the log."""


class Reason(Enum):
    """Why a result is no independent evidence."""

    SAME_LOG = "the same log"
    CONTINUED = "continued from another result"
    DOUBT = "in doubt"


@dataclass(frozen=True)
class LeftOut:
    """A result that is not used."""

    result: LogResult
    reason: Reason
    other: str | None = None  # the result with the same log, or from which this one continued


@dataclass(frozen=True)
class JointLogs:
    """The results of one joint, in the order of time."""

    joint: str
    used: Sequence[LogResult]
    left_out: Sequence[LeftOut]
    failed: Sequence[datetime] = ()  # times of logs that could not be estimated


def by_joint(
    results: Sequence[LogResult], failed: Mapping[str, Sequence[datetime]] | None = None
) -> Sequence[JointLogs]:
    """Sorts results by joint and time, and finds those that are no independent evidence.

    failed  times of logs that could not be estimated, by joint

    Of results with the same log, the first is used: so of a result, and of one that continued from
    it, the one with fewer logs.
    """
    joints: dict[str, list[LogResult]] = {}
    for result in results:
        joints.setdefault(result.joint, []).append(result)
    times = failed or {}
    return [_of_joint(name, joints[name], times.get(name, ())) for name in sorted(joints)]


def _of_joint(joint: str, results: Sequence[LogResult], failed: Sequence[datetime]) -> JointLogs:
    used: list[LogResult] = []
    left_out: list[LeftOut] = []
    seen: dict[str, str] = {}
    # A result of one log comes before those that continued from it.
    for result in sorted(results, key=lambda each: (len(each.digests), each.time, each.place)):
        earlier, own = result.digests[:-1], result.digests[-1:]
        same = next((seen[digest] for digest in own if digest in seen), None)
        if same is not None:
            left_out.append(LeftOut(result, Reason.SAME_LOG, same))
            continue
        if earlier:
            left_out.append(LeftOut(result, Reason.CONTINUED, _first(seen, earlier)))
            continue
        seen |= dict.fromkeys(own, result.place)
        if result.doubt in _USABLE:
            used.append(result)
        else:
            left_out.append(LeftOut(result, Reason.DOUBT))
    used.sort(key=lambda each: (each.time, each.place))
    return JointLogs(joint, used, left_out, failed)


def _first(seen: Mapping[str, str], digests: Sequence[str]) -> str | None:
    return next((seen[digest] for digest in digests if digest in seen), None)
