"""MAT files of version 5 to 7: how much their variables are without compression.

After a head of 128 bytes, each variable is a tag of two integers, kind and number of bytes, and
that many bytes. scipy unpacks a variable of the kind "compressed" whatever it becomes.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path
from typing import IO

from sigmahat.logs.errors import LogError

_COMPRESSED = 15
_HEAD, _TAG = 128, 8  # bytes
_AT_A_TIME = 1 << 20
_PIECE = 1 << 16  # of the file
_MOST = 300_000_000  # bytes
_MOST_OF_PARTS = 80_000_000  # of structures and cells: eight bytes can be an object of a hundred
_NUMBERS = {"double", "single", "logical"} | {
    f"{u}int{n}" for u in ("", "u") for n in (8, 16, 32, 64)
}
_MOST_PER_BYTE = 8  # of the file


def check_packed(path: Path) -> None:
    """Raises LogError for a file that becomes far larger than it is. Others may be damaged."""
    size = path.stat().st_size
    most, unpacked = max(_MOST if _is_plain(path) else _MOST_OF_PARTS, _MOST_PER_BYTE * size), 0
    with path.open("rb") as file:
        head = file.read(_HEAD)
        order = ">" if head[126:128] == b"MI" else "<"
        while len(tag := file.read(_TAG)) == _TAG:
            kind, length = struct.unpack(f"{order}II", tag)
            end = file.tell() + length
            if kind == _COMPRESSED:
                unpacked += _unpacked(file, length, most - unpacked)
            if unpacked > most:
                raise LogError(
                    f"{path}: more than {most / 1e6:.0f} MB in a file of {size / 1e6:.3g} MB; "
                    "save it without compression (-v6), or in parts"
                )
            file.seek(end)


def _unpacked(file: IO[bytes], length: int, most: int) -> int:
    """Number of bytes that the next ones of a file become; counted until it is more than most."""
    unpack, found = zlib.decompressobj(), 0
    try:
        while length > 0 and found <= most and (piece := file.read(min(length, _PIECE))):
            length -= len(piece)
            while piece and found <= most:
                found += len(unpack.decompress(piece, _AT_A_TIME))
                piece = unpack.unconsumed_tail
    except zlib.error:
        pass  # damaged, which scipy says in words
    return found


def _is_plain(path: Path) -> bool:
    """Whether all variables are arrays of numbers, so that the memory goes with the bytes."""
    import scipy.io

    try:
        return all(kind in _NUMBERS for _, _, kind in scipy.io.whosmat(path))
    except Exception:  # any: as for loadmat
        return False
