"""Folders that are written to: filled, or as they were."""

from __future__ import annotations

import subprocess
import sys
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
