"""Sweeps on a Dask cluster of this machine, started as a user starts one."""

from __future__ import annotations

import json
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from sweeps import QUICK, records, refused, run, start, wait_for_records

DASK = [sys.executable, "-m", "dask"]
HERE = ["--host", "127.0.0.1", "--no-dashboard", "--scheduler-file", "scheduler.json"]


@contextmanager
def background(*arguments: str, cwd: Path) -> Iterator[subprocess.Popen[bytes]]:
    process = subprocess.Popen(
        [*DASK, *arguments], cwd=cwd, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        yield process
    finally:
        process.kill()
        process.wait()


@pytest.fixture
def address(tmp_path: Path) -> Iterator[str]:
    """Of a scheduler without workers."""
    with background("scheduler", "--port", "0", *HERE, cwd=tmp_path):
        file = tmp_path / "scheduler.json"
        deadline = time.monotonic() + 60
        while not file.exists() or not file.read_text():
            assert time.monotonic() < deadline
            time.sleep(0.1)
        yield json.loads(file.read_text())["address"]


@contextmanager
def worker(folder: Path, name: str) -> Iterator[subprocess.Popen[bytes]]:
    """A process that does one run at a time."""
    options = ["--nthreads", "1", "--no-nanny", "--name", name, "--local-directory", name]
    with background("worker", *HERE, *options, cwd=folder) as process:
        yield process


def test_one_of_two_workers_killed(address: str, tmp_path: Path) -> None:
    arguments = [*QUICK, "--seeds", "24"]
    with worker(tmp_path, "one") as one, worker(tmp_path, "two"):
        process = start([*arguments, "--scheduler", address, "--out", "cluster"], tmp_path)
        # WHEN a worker is killed while both have work
        path = tmp_path / "cluster" / "runs.jsonl"
        wait_for_records(path, 6, process)
        one.kill()
        done_before = len(records(path))
        output, errors = process.communicate(timeout=120)
    assert (process.returncode, errors) == (0, "")
    assert 6 <= done_before < 24
    # THEN every run is there once, as without a cluster
    numbers = [json.loads(line.partition(b" ")[2])["number"] for line in records(path)]
    assert sorted(numbers) == list(range(24))
    here = run(*arguments, "--out", "here", cwd=tmp_path)
    assert here.stdout.splitlines()[:-1] == output.splitlines()[:-1]
    for name in ("sweep.parquet", "summary.csv", "distributions.svg"):
        assert (tmp_path / "cluster" / name).read_bytes() == (tmp_path / "here" / name).read_bytes()


def test_a_scheduler_without_workers(address: str, tmp_path: Path) -> None:
    line = refused(*QUICK, "--scheduler", address, "--out", "out", cwd=tmp_path)
    assert f"start one with `dask worker {address}`" in line
    assert not (tmp_path / "out").exists()
