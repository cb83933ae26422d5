"""Malicious logs, configurations and plans cause no crash, endless loop or access to files."""

import os
import struct
import zlib
from collections.abc import Callable
from functools import partial
from pathlib import Path

import h5py
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import scipy.io
from hypothesis import HealthCheck, Phase, given, settings

import confined
from confined import MOST_MEMORY, Done
from recorded_logs import CONFIGURATION, plain_log, write_log
from sigmahat.recording.readers.formats import open_log
from strange_files import TRIALS, Trial, complaint_of

FEW = "40" if "SIGMAHAT_COMPLETE" in os.environ else "20"
EXAMPLES = int(os.environ.get("SIGMAHAT_STRANGERS", FEW))
"""Number of random examples. If SIGMAHAT_STRANGERS is set, each test run has other examples."""
CONFIGURED = CONFIGURATION.replace("motor.B", "rls.n = 3\nmotor.B")


Run = Callable[[str], Done]


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Runs a command in a folder with a configuration; the command must not crash."""
    monkeypatch.chdir(tmp_path)
    Path("log.toml").write_text(CONFIGURATION)

    def command(words: str) -> Done:
        done = confined.run(tmp_path, *words.split())
        assert done.complaint() is None
        return done

    return command


@pytest.mark.slow("hundreds of commands, each in a process of its own")
@settings(
    max_examples=EXAMPLES,
    deadline=None,
    derandomize="SIGMAHAT_STRANGERS" not in os.environ,
    database=None,
    phases=[Phase.generate],
    suppress_health_check=list(HealthCheck),
)
@given(trial=TRIALS)
def test_files_that_are_damaged_or_made_up(trial: Trial) -> None:
    assert complaint_of(trial) is None


def mat(values: np.ndarray, path: Path) -> None:
    scipy.io.savemat(path, {"t": values}, do_compression=True)


def kind_in_mat(kind: int, packed: bool, path: Path) -> None:
    """Writes a MATLAB file that declares a wrong number type for a vector."""
    scipy.io.savemat(path, {"t": np.arange(1000.0)})
    content = bytearray(path.read_bytes())
    place = content.index(struct.pack("<II", 9, 8000))
    content[place : place + 4] = struct.pack("<I", kind)
    if packed:
        variable = zlib.compress(bytes(content[128:]))
        content[128:] = struct.pack("<II", 15, len(variable)) + variable
    path.write_bytes(content)


def hdf5(fill: Callable[[h5py.File], object], path: Path) -> None:
    with h5py.File(path, "w") as file:
        fill(file)


def nothing(file: h5py.File) -> None:
    file.create_dataset("a", shape=(10**10,), dtype="f8", chunks=(10**6,), compression="gzip")


def circle(file: h5py.File) -> None:
    file["a/x"] = np.arange(9.0)
    file["a/b"] = file["/"]


def other_file(file: h5py.File) -> None:
    file["a"] = h5py.ExternalLink("other.h5", "/x")


def bytes_of_another_file(file: h5py.File) -> None:
    file.create_dataset("a", shape=(9,), dtype="i1", external=[("/etc/passwd", 0, 9)])


def virtual(file: h5py.File) -> None:
    layout = h5py.VirtualLayout(shape=(9,), dtype="f8")
    layout[:] = h5py.VirtualSource("other.h5", "x", shape=(9,))
    file.create_virtual_dataset("a", layout)


@pytest.mark.parametrize(
    ("write", "words"),
    [
        (partial(mat, np.zeros(20_000_000)), "got 20000000 or more"),
        (partial(kind_in_mat, 39945, False), "damaged MAT file (element of unknown type 39945)"),
        (partial(kind_in_mat, 8, True), "damaged MAT file (element of unknown type 8)"),
        (partial(mat, np.arange(300_000).astype(object)), "at most 1000000 cells and fields"),
        (partial(pq.write_table, pa.table({"t": np.zeros(16_000_000)})), "got 16000000 or more"),
        (partial(hdf5, nothing), "got 10000000000 or more"),
        (partial(hdf5, circle), "levels of groups"),
        (partial(hdf5, other_file), "'a' lies in another file, 'other.h5'"),
        (partial(hdf5, bytes_of_another_file), "'a' lies in another file, '/etc/passwd'"),
        (partial(hdf5, virtual), "'a' lies in another file, 'other.h5'"),
        (
            partial(Path.write_text, data=",".join(f"c{i}" for i in range(100_000)) + "\n1\n"),
            "expected at most 2000 columns, got 100000",
        ),
        (partial(Path.write_text, data="t,q\n" + "1" * 10_000_000), "see line 2"),
        (os.mkfifo, "expected a file, got a pipe or a device"),
        (partial(Path.symlink_to, target="/dev/zero"), "expected a file, got a pipe or a device"),
    ],
)
def test_a_log_that_is_more_than_it_seems(
    write: Callable[[Path], object], words: str, run: Run
) -> None:
    write(Path("log"))
    for command in ("init log --config new.toml", "check log"):
        done = run(command)
        assert done.status == 2 and words in done.err


@pytest.mark.parametrize("value", [0x00, 0xFF])
def test_a_parquet_file_with_a_damaged_description(value: int, run: Run) -> None:
    """GIVEN a wrong byte in the metadata of a file, THEN the file is read or refused. For some
    wrong bytes, a request for the size of a column would make pyarrow abort the process."""
    whole = write_log(plain_log(300), Path("whole.parquet")).read_bytes()
    begin = len(whole) - 8 - int.from_bytes(whole[-8:-4], "little")
    for place in range(begin, begin + 70, 3):
        Path("log").write_bytes(whole[:place] + bytes([value]) + whole[place + 1 :])
        done = run("check log")
        assert "codec" not in done.err or "incomplete Parquet file" in done.err


def test_a_log_of_which_no_tick_can_be_used(run: Run) -> None:
    """GIVEN a scale that makes every value too large, THEN `estimate` reports 300 skipped ticks."""
    too_large = CONFIGURATION.replace('"theta_c"', '"theta_c"\nscale = 1e300')
    write_log(plain_log(300), Path("log.csv"), too_large)
    done = run("estimate log.csv --out results")
    assert done.status == 0 and "300 of 300 ticks skipped" in done.out


def test_many_columns_that_move_are_guessed_in_time(run: Run) -> None:
    values = np.random.default_rng(1).integers(0, 999, (200, 2000)).astype(np.float64)
    write_log({f"c{i}": column for i, column in enumerate(values)}, Path("log.csv"))
    assert run("init log.csv --config new.toml").status == 0


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('column = "q"', 'column = "q"\nunit = "9**9**9**9 rad"', "unknown unit"),
        ('column = "q"', 'column = "q"\nunit = "rad**99999999"', "unknown unit"),
        ('"t"', '"t"\nunit = "9\u2079\u2079\u2079\u2079\u2079 s"', "unknown unit"),
        ("rls.n = 3", f"rls.n = {'9' * 4000}", "rls.n: expected Integer of 32 bits, got 999"),
        ("rls.n = 3", "rls.n = 4294967299", "rls.n: expected Integer of 32 bits, got 4294967299"),
        ("rls.n = 3", "rls.n = [1]", "rls.n: expected Integer, got [1]"),
        ("samplePeriod = 0.001", "samplePeriod = 1e-12", "check time.unit and samplePeriod"),
        ('column = "tau"', 'column = "tau"\ndelay = 1e300', "check its delay"),
        ("[time]", "\n".join(f"a.d{i} = 1" for i in range(1100)) + "\n[time]", "at most 1000 keys"),
        ("[time]", f"a = {'[' * 90}{']' * 90}\n[time]", "at most 6 tables in tables"),
        ("[time]", f"# {'x' * 300_000}\n[time]", "at most 256000 bytes"),
    ],
)
def test_a_configuration_that_would_take_for_ever(old: str, new: str, words: str, run: Run) -> None:
    write_log(plain_log(300), Path("log.csv"))
    assert CONFIGURED.count(old) == 1
    Path("log.toml").write_text(CONFIGURED.replace(old, new), encoding="utf-8")
    done = run("check log.csv")
    assert done.status == 2 and words in done.err


def test_names_of_columns_are_no_paths_and_no_commands(run: Run, tmp_path: Path) -> None:
    columns = plain_log(300)
    odd = {f"../{joint}/{n}\x1b[31m": columns[n] for joint in "xy" for n in ("theta", "q", "tau")}
    write_log({"t": columns["t"], **odd}, Path("log.csv"))
    beside = {*tmp_path.parent.iterdir()}
    done = run("init log.csv --config log2.toml")
    assert "\x1b" not in done.out + done.err
    assert {*tmp_path.parent.iterdir()} == beside
    assert all(each.name.startswith("log") for each in Path().iterdir())


def test_many_columns_that_repeat_are_few_bytes_and_no_bomb(run: Run) -> None:
    motion = np.sin(0.01 * (np.arange(100_000) % 628))
    names = ["theta", "q", "theta_c", "tau", *(f"c{i}" for i in range(195))]
    write_log({"t": 1e-3 * np.arange(100_000), **dict.fromkeys(names, motion)}, Path("log.parquet"))
    done = run("check log.parquet")
    assert done.status in (0, 1) and done.megabytes < MOST_MEMORY, done.err


def test_many_columns_that_are_packed_well(tmp_path: Path) -> None:
    values = np.zeros((100_000, 200))
    with h5py.File(tmp_path / "log.h5", "w") as file:
        file.create_dataset("x", data=values, compression="gzip", chunks=(100_000, 1))
    assert len(open_log(tmp_path / "log.h5").columns) == 200
    scipy.io.savemat(tmp_path / "log.mat", {"x": values[:, :70]}, do_compression=True)
    assert len(open_log(tmp_path / "log.mat").columns) == 70
