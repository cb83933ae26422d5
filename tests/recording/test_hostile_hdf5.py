"""HDF5 files that lead to other files, or are larger than they seem."""

import zlib
from collections.abc import Callable
from pathlib import Path

import h5py
import numpy as np
import pytest

from sigmahat.recording.log import LogError
from sigmahat.recording.readers.formats import open_log

Fill = Callable[[h5py.File], object]


def write(path: Path, fill: Fill) -> Path:
    with h5py.File(path, "w") as file:
        file["t"] = np.arange(9.0)
        fill(file)
    return path


def to_a_value(file: h5py.File) -> None:
    file["#e"] = h5py.ExternalLink("other.h5", "/")
    file["a"] = h5py.SoftLink("/#e/t")


def through_soft_links(file: h5py.File) -> None:
    file["#e"] = h5py.ExternalLink("other.h5", "/")
    file["#b"] = h5py.SoftLink("/#e")
    file["a"] = h5py.SoftLink("#b/./t")


def in_a_group(file: h5py.File) -> None:
    file["g/#e"] = h5py.ExternalLink("other.h5", "/")
    file["g/a"] = h5py.SoftLink("#e/t")


def to_a_group(file: h5py.File) -> None:
    file["#e"] = h5py.ExternalLink("other.h5", "/g")
    file["a"] = h5py.SoftLink("/#e")


@pytest.mark.parametrize("fill", [to_a_value, through_soft_links, in_a_group, to_a_group])
@pytest.mark.parametrize("other", [True, False])
def test_links_to_another_file_are_not_followed(fill: Fill, other: bool, tmp_path: Path) -> None:
    """GIVEN soft links through an external link, THEN the message is the same whether there is the
    other file or not, as it is not opened."""
    if other:
        write(tmp_path / "other.h5", lambda file: file.create_group("g"))
    with pytest.raises(LogError, match=r"lies in another file, 'other\.h5'"):
        open_log(write(tmp_path / "log.h5", fill))


def test_soft_links_inside_of_the_file_are_followed(tmp_path: Path) -> None:
    def fill(file: h5py.File) -> None:
        file["g/x"] = np.arange(9.0)
        file["a"] = h5py.SoftLink("/g/x")
        file["b"] = h5py.SoftLink("g")
        file["nothing"] = h5py.SoftLink("g/y/z")

    assert list(open_log(write(tmp_path / "log.h5", fill)).columns) == ["a", "b.x", "g.x", "t"]


def to_itself(file: h5py.File) -> None:
    file["a"] = h5py.SoftLink("a")


def to_many(file: h5py.File) -> None:
    for k in range(20):
        file[f"l{k}"] = h5py.SoftLink(f"l{k + 1}/x" * 3)
        file[f"g{k}/x"] = 1
    for k in range(19):
        for name in "abc":
            file[f"g{k}/{name}"] = file[f"g{k + 1}"]


def large_chunk(file: h5py.File) -> None:
    many = {"chunks": (100_000_000,), "maxshape": (None,)}
    file.create_dataset("a", shape=(9,), dtype="f8", compression="gzip", **many)


def bomb(file: h5py.File) -> None:
    a = file.create_dataset("a", shape=(9,), dtype="f8", compression="gzip", chunks=(9,))
    a.id.write_direct_chunk((0,), zlib.compress(bytes(5_000_000)))


@pytest.mark.parametrize(
    ("fill", "words"),
    [
        (to_itself, "links to links"),
        (to_many, "groups and data sets"),
        (large_chunk, "800 MB"),
        (bomb, "'a' is larger than its chunks"),
    ],
)
def test_files_that_would_take_memory_or_time(
    fill: Fill, words: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sigmahat.recording.readers.matrices._MOST_STEPS", 1000)
    monkeypatch.setattr("sigmahat.recording.readers.matrices._SMALL", 1000)
    with pytest.raises(LogError, match=words):
        open_log(write(tmp_path / "log.h5", fill))
