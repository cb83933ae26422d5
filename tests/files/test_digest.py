"""SHA-256 of logs, as sha256sum prints it."""

from __future__ import annotations

import hashlib
import shutil
import subprocess
from pathlib import Path

from gate import need
from sigmahat.files.output import sha256


def test_of_a_file(tmp_path: Path) -> None:
    path = tmp_path / "log.csv"
    path.write_bytes(b"abc")
    assert sha256(path) == "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"
    path.write_bytes(bytes(range(256)) * 10_000)  # more than is read at a time
    assert sha256(path) == hashlib.sha256(path.read_bytes()).hexdigest()


def test_of_a_folder(tmp_path: Path) -> None:
    """A ROS 2 bag: any change of a file, or of its name, changes it."""
    bag = tmp_path / "bag"
    (bag / "more").mkdir(parents=True)
    (bag / "metadata.yaml").write_text("a")
    (bag / "more" / "bag.db3").write_text("b")
    found = sha256(bag)
    assert found == sha256(shutil.copytree(bag, tmp_path / "copy"))
    (bag / "more" / "bag.db3").write_text("c")
    assert sha256(bag) != found
    (bag / "more" / "bag.db3").write_text("b")
    (bag / "metadata.yaml").rename(bag / "metadata.yml")
    assert sha256(bag) != found


def test_of_a_folder_is_that_of_the_list_of_sha256sum(tmp_path: Path) -> None:
    for name in ("b", "a"):
        (tmp_path / name).write_text(name)
    command = [need("sha256sum"), "a", "b"]
    listed = subprocess.run(command, cwd=tmp_path, capture_output=True, check=True)
    assert sha256(tmp_path) == hashlib.sha256(listed.stdout).hexdigest()
