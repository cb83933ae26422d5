"""Mutated and random logs, configurations and plans for fuzzing."""

from pathlib import Path
from tempfile import TemporaryDirectory

from hypothesis import strategies as st

import confined
from recorded_logs import CONFIGURATION, plain_log, write_log

_WORDS = "0 -1 1e999 -1e-999 nan inf 1e308 5e-324 1e-12 0x7f 1e300 true [1,2] {a=1} 1979-05-27 []"
_NAMES = "../../x/theta /etc/passwd ~ {{7*7}} $$q$$ %n%s theta q tau theta_c 0 time A.B/C.d \u00b5"
_HOSTILE = ["<script>alert(1)</script>", "=cmd|' /C calc'!A0", "\x1b[31mq", "q\u202e", "q" * 5000]
_UNITED = ["theta [9**9**9**9]", "t [rad**999999999]", "t [s]", "x y"]
NUMBERS = st.sampled_from([*_WORDS.split(), '"text"', '"\\u0000"', "9" * 30, "9" * 5000])
TEXTS = st.sampled_from([*_NAMES.split(), *_HOSTILE, *_UNITED])
CELLS = st.one_of(
    st.floats().map(repr), st.integers().map(str), st.sampled_from(["", "x", '"', "1e999", "\0"])
)
_KEYS = [
    *("column", "unit", "sign", "zero", "gear_ratio"),
    *("counts_per_turn", "scale", "wrap", "delay"),
]
_UNITS = ["deg", "counts", "A", "9**9**9**9", "rad**99", "(" * 39, "N.m.s", "rad^-2", "1/0", ""]


def _usual_bytes(suffix: str) -> bytes:
    with TemporaryDirectory() as folder:
        return write_log(plain_log(300), Path(folder, f"log{suffix}")).read_bytes()


_WHOLE = {suffix: _usual_bytes(suffix) for suffix in (".csv", ".parquet", ".mat", ".h5")}


@st.composite
def damaged_logs(draw: st.DrawFn) -> bytes:
    """A log with some bytes changed, cut, doubled or put in."""
    data = bytearray(_WHOLE[draw(st.sampled_from(sorted(_WHOLE)))])
    for _ in range(draw(st.integers(1, 3))):
        # Places at which the formats have lengths: the beginning and the end.
        near = draw(st.integers(0, min(2000, len(data) - 1))) if data else 0
        place = draw(st.sampled_from([near, max(0, len(data) - 1 - near)]))
        sizes = st.sampled_from([b"\xff\xff\xff\x7f", b"\0\0\0\x10"])
        again = st.just(bytes(data[place : place + 4096]))
        removed, put = draw(
            st.one_of(
                st.tuples(st.just(1), st.binary(min_size=1, max_size=1)),
                st.tuples(st.just(4), sizes),
                st.tuples(st.integers(1, 64) | st.just(len(data)), st.just(b"")),
                st.tuples(st.just(0), st.binary(max_size=64) | again),
            )
        )
        data[place : place + removed] = put
    return bytes(data)


@st.composite
def odd_tables(draw: st.DrawFn) -> bytes:
    """A CSV file with odd names, cells, delimiters and line ends."""
    names = draw(st.lists(TEXTS, min_size=1, max_size=8))
    cells = st.lists(CELLS, min_size=max(1, len(names) - 1), max_size=len(names) + 1)
    rows = draw(st.lists(cells, max_size=6)) * draw(st.sampled_from([1, 50]))
    between, end = draw(st.sampled_from([",", ";", "\t"])), draw(st.sampled_from(["\n", "\r\n"]))
    text = end.join(between.join(row) for row in [names, *rows])
    return text.encode("utf-8", "surrogatepass")


@st.composite
def odd_configurations(draw: st.DrawFn) -> bytes:
    """A configuration with keys, values and units that do not fit, or with bytes changed."""
    lines = CONFIGURATION.splitlines()
    for _ in range(draw(st.integers(1, 3))):
        place = draw(st.integers(0, len(lines)))
        key = draw(st.sampled_from([*_KEYS, "samplePeriod", "rls.n", "motor.B", "longest_gap"]))
        unit = draw(st.sampled_from(_UNITS))
        value = f'"{unit}"' if key == "unit" else draw(NUMBERS)
        if draw(st.booleans()):
            lines.insert(place, f"{key} = {value}")
        elif place < len(lines) and "=" in lines[place]:
            lines[place] = f"{lines[place].partition('=')[0]}= {value}"
    data = bytearray("\n".join(lines).encode())
    if draw(st.integers(0, 3)) == 0:
        data[draw(st.integers(0, len(data) - 1))] = draw(st.integers(0, 255))
    return bytes(data)


Trial = tuple[str, dict[str, bytes]]
"""A command, and the files that it finds in its folder."""


def complaint_of(trial: Trial) -> str | None:
    """A forbidden action of a command that a file has caused; its folder is removed."""
    command, files = trial
    with TemporaryDirectory() as folder:
        for name, content in files.items():
            Path(folder, name).write_bytes(content)
        return confined.run(Path(folder), *command.split()).complaint()


def _trial(command: str, log: bytes, configuration: bytes) -> Trial:
    return command, {"log": log, "log.toml": configuration}


_LOGS = st.one_of(damaged_logs(), odd_tables())
_GOOD, _USUAL = st.just(CONFIGURATION.encode()), st.sampled_from(sorted(_WHOLE.values()))
TRIALS = st.one_of(
    st.builds(_trial, st.just("init log --config new.toml"), _LOGS, _GOOD),
    st.builds(_trial, st.sampled_from(["check log", "identify log --dry-run"]), _LOGS, _GOOD),
    st.builds(_trial, st.just("check log"), _USUAL, odd_configurations()),
    st.builds(_trial, st.just("estimate log"), _USUAL, odd_configurations()),
)
"""Commands with logs and configurations that are damaged or made up."""
