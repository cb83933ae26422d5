"""Folders that are written to: filled, or as they were."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from sigmahat.files.output import created_folder, output_folder, write_whole


def test_folder_appears_filled_or_not_at_all(tmp_path: Path) -> None:
    out = tmp_path / "a" / "b"
    with pytest.raises(RuntimeError), output_folder(out) as unfinished:
        (unfinished / "half.csv").write_text("")
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []
    with output_folder(out) as unfinished:
        (unfinished / "whole.csv").write_text("1")
        assert not (out / "whole.csv").exists()
    assert [path.name for path in out.iterdir()] == ["whole.csv"]


def test_failure_keeps_earlier_results(tmp_path: Path) -> None:
    (tmp_path / "table.csv").write_text("earlier")
    with pytest.raises(RuntimeError), output_folder(tmp_path) as unfinished:
        (unfinished / "table.csv").write_text("half")
        raise RuntimeError
    assert [path.name for path in tmp_path.iterdir()] == ["table.csv"]
    assert (tmp_path / "table.csv").read_text() == "earlier"


def test_a_created_folder_that_stays_empty_is_removed(tmp_path: Path) -> None:
    with created_folder(tmp_path / "a" / "b", ignored="lock"):
        (tmp_path / "a" / "b" / "lock").write_text("")
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_was_there_or_holds_something_stays(tmp_path: Path) -> None:
    with created_folder(tmp_path / "a" / "b", ignored="lock"):
        (tmp_path / "a" / "b" / "result").write_text("")
    with created_folder(tmp_path / "a"):
        pass
    assert [p.name for p in (tmp_path / "a" / "b").iterdir()] == ["result"]


WRITES = """
import sys, time
from pathlib import Path
from sigmahat.files.output import output_folder
with output_folder(Path(sys.argv[1])) as folder:
    (folder / "table.csv").write_text("half")
    print("writing", flush=True)
    time.sleep(300)
"""


@contextmanager
def another_process(out: Path) -> Iterator[str]:
    """One that is in the middle of writing, by its number; it is killed at the end."""
    with subprocess.Popen(
        [sys.executable, "-c", WRITES, str(out)], stdout=subprocess.PIPE, text=True
    ) as process:
        try:
            assert process.stdout is not None and process.stdout.readline() == "writing\n"
            yield str(process.pid)
        finally:
            process.kill()


def write_folder(path: Path) -> None:
    with output_folder(path) as folder:
        (folder / "new.txt").write_text("new")


def write_file(path: Path) -> None:
    write_whole("new", path / "new.txt")


@pytest.mark.parametrize("write", [write_folder, write_file])
def test_what_killed_processes_left_is_removed_and_nothing_else(
    write: Callable[[Path], None], tmp_path: Path
) -> None:
    (tmp_path / "table.csv").write_text("earlier")
    # GIVEN one process that still writes, and one that was killed while it wrote
    with another_process(tmp_path) as writing:
        (stays,) = tmp_path.glob(".unfinished-*")
        with another_process(tmp_path) as killed:
            left = tmp_path / stays.name.replace(writing, killed)
        assert left.is_dir()
        # AND the same of another machine, a folder of the user, and what had this number before
        others = {left.name + "-other", ".unfinished-business", f".unfinished-{killed}"}
        own = stays.name.replace(writing, str(os.getpid()))
        for name in (*others, own):
            (tmp_path / name).mkdir()
        (tmp_path / own / "old.txt").write_text("old")
        # WHEN something is written there
        write(tmp_path)
        # THEN what is left over is gone, and nothing else
        names = {path.name for path in tmp_path.iterdir()}
        assert names == {*others, stays.name, "table.csv", "new.txt"}
        assert (stays / "table.csv").read_text() == "half"
    assert (tmp_path / "table.csv").read_text() == "earlier"
    assert (tmp_path / "new.txt").read_text() == "new"


def test_a_file_is_replaced_at_once_or_not_changed(tmp_path: Path) -> None:
    path, link = tmp_path / "knee.toml", tmp_path / "link.toml"
    path.write_text("earlier")
    link.symlink_to(path)
    with pytest.raises(UnicodeEncodeError):
        write_whole("half\ud800", link)
    assert path.read_text() == "earlier"
    write_whole("whole", link)
    assert (link.is_symlink(), path.read_text()) == (True, "whole")
    assert len(list(tmp_path.iterdir())) == 2
    with pytest.raises(OSError) as error:
        write_whole("", tmp_path / "missing" / "knee.toml")
    assert error.value.filename == str(tmp_path / "missing" / "knee.toml")


def test_a_device_is_written_to(tmp_path: Path) -> None:
    code = "from sigmahat.files.output import *; write_whole('text', Path('/dev/stdout'))"
    command = [sys.executable, "-c", code]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert (done.stdout, done.stderr) == ("text", "")
