"""Damages files at random, and notes what reading them took."""

import multiprocessing
import re
import resource
import time
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from sigmahat.recording.configuration import joints_of, read_configuration, read_document
from sigmahat.recording.estimator_parameters import all_parameters
from sigmahat.recording.log import LogError
from sigmahat.recording.readers.formats import open_log
from sigmahat.result.estimate_table import REPLAYED
from sigmahat.result.learned import LEARNED
from sigmahat.result.sheet import FORMAT

_SIZES = [b"\xff\xff\xff\x7f", b"\xff\xff\xff\xff", b"\0\0\0\x10", b"\0\0\0\0", b"\x01\0\0\0"]
_NUMBERS = "0 -1 1e999 -1e-999 nan inf 1e308 -1e308 1e-308 5e-324 9223372036854775808 3 7"
_OTHERS = 'true false null [] {} "" "text" [1,2] 1979-05-27 {a=1} "\\u0000"'
_LONG = ["9" * 5000, "[" * 2000, '"' + "x" * 5000 + '"']
_WORDS = [*_NUMBERS.split(), *_OTHERS.split(), *_LONG]
_VALUE = re.compile(rb"[-+\w.]+|\"[^\"]*\"")
_LONGEST = 13_000  # characters of a message, which can list 150 names of 80 characters
_MOST_ADDRESSES = 4 << 30  # bytes


@dataclass
class Figures:
    """What the reading of damaged files took at most."""

    refused: int = 0
    seconds: float = 0.0  #: Of the slowest, in processor time.
    megabytes: float = 0.0  #: Peak of the memory of the process.
    complaint: str = ""  #: The first error that is not one line.


def damaged(whole: bytes, random: np.random.Generator, is_text: bool) -> bytes:
    """Changes, cuts, doubles or inserts bytes, or values of a text, at one to four places."""
    data = bytearray(whole)
    for _ in range(random.integers(1, 5)):
        if is_text and random.random() < 0.7:
            data = _other_value(data, random)
            continue
        # Lengths and directories are at the beginning and the end of most formats.
        reach = len(data) if random.random() < 0.5 else min(len(data), 600)
        near = int(random.integers(0, max(reach, 1)))
        place = near if random.random() < 0.6 else max(len(data) - 1 - near, 0)
        kind = random.integers(0, 5)
        if kind == 0:
            data[place : place + 1] = random.bytes(1)
        elif kind == 1:
            data[place : place + 4] = _SIZES[random.integers(0, len(_SIZES))]
        elif kind == 2:
            del data[place : place + int(random.choice([1, 8, 64, len(data)]))]
        elif kind == 3:
            data[place:place] = data[place : place + 200]
        else:
            data[place:place] = random.bytes(int(random.integers(1, 20)))
    return bytes(data)


def _other_value(data: bytearray, random: np.random.Generator) -> bytearray:
    """Puts another value in place of a number, a name or a text."""
    places = [each.span() for each in _VALUE.finditer(data)]
    if places:
        begin, end = places[random.integers(0, len(places))]
        data[begin:end] = _WORDS[random.integers(0, len(_WORDS))].encode()
    return data


def attack(
    read: Callable[[Path], object], whole: bytes, seeds: range, is_text: bool, name: str
) -> Figures:
    """Reads damaged files. A ValueError in one line is right; any other error is a complaint.

    name  of the file
    """
    figures = Figures()
    with TemporaryDirectory() as folder:
        path = Path(folder, name)
        for seed in seeds:
            path.write_bytes(damaged(whole, np.random.default_rng(seed), is_text))
            begin = time.process_time()
            try:
                read(path)
            except ValueError as error:
                figures.refused += 1
                text = str(error)
                if "\n" in text or len(text) > _LONGEST:
                    figures.complaint = figures.complaint or f"{seed}: {text[:2000]}"
            except Exception as error:
                figures.complaint = figures.complaint or f"{seed}: {error!r}"[:2000]
            figures.seconds = max(figures.seconds, time.process_time() - begin)
    figures.megabytes = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss * 1024 / 1e6
    return figures


def attack_in_process(
    read: Callable[[Path], object], whole: bytes, seeds: range, is_text: bool, name: str
) -> Figures:
    """As attack(), in a process of its own, so that its memory is measured and limited."""
    context = multiprocessing.get_context("forkserver")
    with ProcessPoolExecutor(1, context, _limit) as pool:
        return pool.submit(attack, read, whole, seeds, is_text, name).result()


def read_log(path: Path) -> None:
    """Reads all columns; some of a damaged log can be refused."""
    log = open_log(path)
    for name in log.columns:
        try:
            log.read(name)
        except LogError as error:
            assert "\n" not in str(error)


def read_configured(path: Path) -> None:
    for joint in joints_of(read_document(path), path):
        all_parameters(read_configuration(path, joint))


def read_result(path: Path) -> None:
    formats = {each.file: each for each in (REPLAYED, LEARNED, FORMAT)}
    formats[path.name].read(path)


def _limit() -> None:
    resource.setrlimit(resource.RLIMIT_AS, (_MOST_ADDRESSES, _MOST_ADDRESSES))
