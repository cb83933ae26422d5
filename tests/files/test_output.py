"""An output folder is written completely or not at all. SHA-256 digests of files and folders."""

import hashlib
import os
import random
import re
import resource
import shutil
import stat
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

import sigmahat
from controllers import run
from gate import need
from sigmahat.files.output import created_folder, output_folder, sha256, write_json, write_whole
from sigmahat.files.tables import write_csv
from sigmahat.plant_fmu import archive


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
    with created_folder(tmp_path / "a"):  # the folder exists
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


@contextmanager
def full_disk(free: int = 1000) -> Iterator[None]:
    """Files take only this number of bytes, and further bytes are an error of the system."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (free, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)


def archive_of(path: Path) -> None:
    archive.write(path, {"random": bytes(random.Random(1).randbytes(5000))})


def folder_of(path: Path) -> None:
    with output_folder(path.parent) as folder:
        (folder / "first").write_text("new")
        (folder / path.name).write_text("x" * 5000)


WRITERS: dict[str, Callable[[Path], object]] = {
    "a text": lambda path: write_whole("x" * 5000, path),
    "JSON": lambda path: write_json(["x" * 5000], path),
    "CSV": lambda path: write_csv(path, ["x"], [["x" * 5000]]),
    "an FMU": archive_of,
    "a folder": folder_of,
}


@pytest.mark.parametrize("write", WRITERS.values(), ids=WRITERS)
def test_a_full_disk_leaves_the_old_file_whole(
    write: Callable[[Path], object], tmp_path: Path
) -> None:
    path = tmp_path / "knee"
    path.write_text("earlier")
    with full_disk(), pytest.raises(OSError):
        write(path)
    assert (path.read_text(), [*tmp_path.iterdir()]) == ("earlier", [path])
    path.chmod(0o640)
    write(path)
    assert path.stat().st_size >= 5000 and stat.S_IMODE(path.stat().st_mode) == 0o640


def test_other_writers_write_into_temporary_folders_only() -> None:
    package = Path(sigmahat.__file__).parent
    writes = re.compile(r"\.write_(text|bytes)\(|open\(\s*\"w")
    found = {
        path.relative_to(package).as_posix()
        for path in package.rglob("*.py")
        if writes.search(path.read_text(encoding="utf-8"))
    }
    assert found == {
        *("files/output.py", "files/tables.py"),
        "recording/readers/bag_files.py",  # an unpacked bag
        "result/estimate_table.py",  # into the output folder of `estimate`
        *("plant_fmu/plant_codegen.py", "plant_fmu/plant_fmu.py"),  # sources of an FMU
    }


def test_the_bytes_are_on_the_disk_before_the_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path, seen = tmp_path / "knee", list[tuple[int, str]]()
    path.write_text("earlier")

    def synced(descriptor: int) -> None:
        seen.append((os.fstat(descriptor).st_ino, path.read_text()))

    monkeypatch.setattr(os, "fsync", synced)
    write_whole("whole", path)
    file, folder = path.stat().st_ino, tmp_path.stat().st_ino
    assert seen == [(file, "earlier"), (folder, "whole")]


def test_a_device_is_written_to(tmp_path: Path) -> None:
    code = "from sigmahat.files.output import *; write_whole('text', Path('/dev/stdout'))"
    assert run(sys.executable, "-c", code, cwd=tmp_path) == "text"


def test_the_digest_of_a_folder(tmp_path: Path) -> None:
    """The digest of a folder depends on the content and the name of each file, as in sha256sum."""
    bag = tmp_path / "bag"
    (bag / "more").mkdir(parents=True)
    (bag / "metadata.yaml").write_bytes(bytes(range(256)) * 10_000)  # over one block
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
