"""Folders that are written to: filled, or as they were. SHA-256 of files and folders."""

import hashlib
import shutil
import sys
from pathlib import Path

import pytest

from controllers import run
from gate import need
from sigmahat.files.output import created_folder, output_folder, sha256, write_whole


def test_folder_appears_filled_or_not_at_all(tmp_path: Path) -> None:
    out = tmp_path / "a" / "b"
    with pytest.raises(RuntimeError), output_folder(out) as unfinished:
        (unfinished / "half.csv").write_text("")
        raise RuntimeError
    assert list(tmp_path.iterdir()) == []
    with output_folder(out) as unfinished:
        (unfinished / "whole.csv").write_text("1")
        assert not (out / "whole.csv").exists()
    with pytest.raises(RuntimeError), output_folder(out) as unfinished:
        (unfinished / "whole.csv").write_text("half")
        raise RuntimeError
    assert [path.name for path in out.iterdir()] == ["whole.csv"]
    assert (out / "whole.csv").read_text() == "1"


def test_a_created_folder_that_stays_empty_is_removed(tmp_path: Path) -> None:
    folder = tmp_path / "a" / "b"
    with created_folder(folder):
        assert folder.is_dir()
    assert list(tmp_path.iterdir()) == []
    with created_folder(folder):
        (folder / "result").write_text("")
    with created_folder(tmp_path / "a"):  # it was there
        pass
    assert [p.name for p in folder.iterdir()] == ["result"]


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
    assert run(sys.executable, "-c", code, cwd=tmp_path) == "text"


def test_the_digest_of_a_folder(tmp_path: Path) -> None:
    """Hash of the list of sha256sum. Any change of a file, or of its name, changes it."""
    bag = tmp_path / "bag"
    (bag / "more").mkdir(parents=True)
    (bag / "metadata.yaml").write_bytes(bytes(range(256)) * 10_000)  # more than is read at a time
    (bag / "more" / "bag.db3").write_text("b")
    listed = run(need("sha256sum"), "metadata.yaml", "more/bag.db3", cwd=bag)
    found = sha256(bag)
    assert found == hashlib.sha256(listed.encode()).hexdigest()
    assert found == sha256(shutil.copytree(bag, tmp_path / "copy"))
    (bag / "more" / "bag.db3").write_text("c")
    assert sha256(bag) != found
    (bag / "more" / "bag.db3").write_text("b")
    (bag / "metadata.yaml").rename(bag / "metadata.yml")
    assert sha256(bag) != found
