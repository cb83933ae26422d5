"""MAT files of version 5 to 7: how much their variables are without compression.

After a head of 128 bytes, each variable is a tag of two integers, kind and number of bytes, and
that many bytes. scipy unpacks a variable of the kind "compressed" whatever it becomes.
"""

from __future__ import annotations

import struct
import zlib
from pathlib import Path

from sigmahat.logs.errors import LogError

_COMPRESSED = 15
_HEAD, _TAG = 128, 8  # bytes
_AT_A_TIME = 1 << 20
_MOST = 80_000_000  # bytes; a byte can be a number, which takes eight of them in memory
_MOST_PER_BYTE = 8  # of the file


def check_packed(path: Path) -> None:
    """Raises LogError for a file that becomes far larger than it is. Others may be damaged."""
    size = path.stat().st_size
    most, unpacked = max(_MOST, _MOST_PER_BYTE * size), 0
    with path.open("rb") as file:
        head = file.read(_HEAD)
        order = ">" if head[126:128] == b"MI" else "<"
        while len(tag := file.read(_TAG)) == _TAG:
            kind, length = struct.unpack(f"{order}II", tag)
            end = file.tell() + length
            if kind == _COMPRESSED:
                unpacked += _unpacked(file.read(length), most - unpacked)
            if unpacked > most:
                raise LogError(
                    f"{path}: more than {most / 1e6:.0f} MB in a file of {size / 1e6:.3g} MB; "
                    "save it without compression (-v6), or in parts"
                )
            file.seek(end)


def _unpacked(packed: bytes, most: int) -> int:
    """Number of bytes that some become, or one more than most."""
    unpack, found = zlib.decompressobj(), 0
    try:
        while packed and found <= most:
            found += len(unpack.decompress(packed, _AT_A_TIME))
            packed = unpack.unconsumed_tail
    except zlib.error:
        pass  # damaged, which scipy says in words
    return found
