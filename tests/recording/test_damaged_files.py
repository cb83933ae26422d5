"""Damaged files of all formats that are read: each is read, or refused in one line."""

import json
import os
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from rosbags.rosbag1 import Writer as Writer1
from rosbags.typesys import Stores, get_typestore

from damage import (
    Figures,
    attack,
    attack_in_process,
    read_configured,
    read_log,
    read_result,
)
from recorded_logs import CONFIGURATION, estimated, plain_log, write_log
from sigmahat.recording.log import LogError
from sigmahat.recording.readers.formats import open_log
from small_bags import FLOAT, mcap_bag, sqlite_bag

EXAMPLES = 5000 if "SIGMAHAT_COMPLETE" in os.environ else 12
"""Number of damaged files of each format."""
LONGEST, MOST_MEMORY = 10.0, 1000.0
"""Processor time for a file [s], and memory of the process that reads them [MB]."""

Make = Callable[[Path], Path]


def log_file(name: str) -> Make:
    return lambda folder: write_log(plain_log(40), folder / name)


def db3(folder: Path) -> Path:
    sqlite_bag(folder / "log.db3", definition="float64 data\n")
    return folder / "log.db3"


def mcap(folder: Path) -> Path:
    mcap_bag(folder / "log.mcap", FLOAT, "float64 data\n")
    return folder / "log.mcap"


def ros1(folder: Path) -> Path:
    store = get_typestore(Stores.ROS1_NOETIC)
    with Writer1(folder / "log.bag") as writer:
        number = "std_msgs/msg/Float64"
        topic = writer.add_connection("/a", number, typestore=store)
        for k in range(2):
            message = store.types[number](0.5)
            writer.write(topic, k, store.serialize_ros1(message, number))
    return folder / "log.bag"


def json_lines(folder: Path) -> Path:
    columns = [(name, values.tolist()) for name, values in plain_log(40).items()]
    rows = ({name: values[k] for name, values in columns} for k in range(40))
    lines = (json.dumps({"drive": row, "pair": [k, {"x": k}]}) for k, row in enumerate(rows))
    (folder / "log.jsonl").write_text("\n".join(lines))
    return folder / "log.jsonl"


def toml(folder: Path) -> Path:
    (folder / "log.toml").write_text(CONFIGURATION)
    return folder / "log.toml"


LOGS: dict[str, Make] = {
    "csv": log_file("log.csv"),
    "parquet": log_file("log.parquet"),
    "mat": log_file("log.mat"),
    "hdf5": log_file("log.h5"),
    "json": json_lines,
    "db3": db3,
    "mcap": mcap,
    "ros1": ros1,
}


@pytest.fixture(scope="module")
def results(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The folder that `sigmahat estimate` writes."""
    folder = estimated(tmp_path_factory.mktemp("estimated"), plain_log(60), CONFIGURATION)
    return folder / "sigmahat-results" / "knee"


def check(read: Callable[[Path], object], file: Path) -> None:
    is_text = file.suffix in (".csv", ".toml", ".json", ".jsonl")
    run = attack_in_process if "SIGMAHAT_COMPLETE" in os.environ else attack
    figures: Figures = run(read, file.read_bytes(), range(EXAMPLES), is_text, file.name)
    print(file.name, figures)
    assert not figures.complaint
    assert figures.refused
    assert figures.seconds < LONGEST
    if run is attack_in_process:
        assert figures.megabytes < MOST_MEMORY


@pytest.mark.parametrize("kind", LOGS)
def test_damaged_logs(kind: str, tmp_path: Path) -> None:
    check(read_log, LOGS[kind](tmp_path))


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('{"a":' + "[" * 10_000 + "]" * 10_000 + "}", "at most 32 levels"),
        ('{"a":' + "[" * 500_000, "at most 32 levels"),
        ('{"a":"' + '\\"' * 400_000, "expected one JSON object"),
        ("".join(f'{{"k{i}":1}}\n' for i in range(60_000)), "at most 2000 columns"),
        ("".join(f'{{"a":{{"k{i}":1}}}}\n' for i in range(60_000)), "at most 2000 columns"),
        ("".join(f'{{"k{i % 1990}":1}}\n' for i in range(20_000)), "at most 30000000 numbers"),
        ('{"a":"' + "x" * 2_000_000 + '"}', "see line 1"),
        (f'{{"{"k" * 500_000}":[1,"a"]}}', "expected one JSON object"),
    ],
    ids=["arrays", "open", "escapes", "names", "paths", "sparse", "long", "name"],
)
def test_json_lines_that_are_more_than_they_seem(text: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "log.jsonl").write_text(text)
    begin = time.process_time()
    with pytest.raises(LogError, match=words) as refused:
        open_log(tmp_path / "log.jsonl")
    assert len(str(refused.value)) < 500 + len(str(tmp_path))
    assert time.process_time() - begin < 3


@pytest.mark.parametrize(
    "text", ["[" + "12:00:00" * 100_000 + "\n", "t\n" + "[1," * 300_000 + "\n"]
)
def test_long_lines_without_an_end_of_brackets(text: str, tmp_path: Path) -> None:
    (tmp_path / "log.csv").write_text(text * 3)
    begin = time.process_time()
    with pytest.raises(LogError):
        open_log(tmp_path / "log.csv")
    assert time.process_time() - begin < 5


def test_damaged_configurations(tmp_path: Path) -> None:
    check(read_configured, toml(tmp_path))


def test_damaged_results(tmp_path: Path, results: Path) -> None:
    for name in ("joint.json", "state.json", "estimate.json"):
        check(read_result, results / name)
