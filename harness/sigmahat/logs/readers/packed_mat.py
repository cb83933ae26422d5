"""MAT files of version 5 to 7: how much they are without compression, and the kinds of elements.

After a head of 128 bytes, each variable is a tag of two integers, kind and number of bytes, and
that many bytes. A variable is a sequence of such elements again. scipy unpacks a variable of the
kind "compressed" whatever it becomes, and uses the kind of an element as an index without a check.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from pathlib import Path
from typing import IO

from sigmahat.logs.log import LogError

_MATRIX, _COMPRESSED = 14, 15
_KINDS = {*range(1, 8), 9, 12, 13, _MATRIX, 16, 17, 18}  # numbers, matrices, text
_HEAD, _TAG = 128, 8  # bytes
_AT_A_TIME = 1 << 20
_PIECE = 1 << 16  # of the file
_MOST = 300_000_000  # bytes
_MOST_OF_PARTS = 80_000_000  # of structures and cells: eight bytes can be an object of a hundred
_MOST_ELEMENTS = 1_000_000
_NUMBERS = {"double", "single", "logical"} | {
    f"{u}int{n}" for u in ("", "u") for n in (8, 16, 32, 64)
}
_MOST_PER_BYTE = 8  # of the file


def check_packed(path: Path) -> None:
    """Raises LogError for a file that becomes far larger than it is, or has unknown elements.

    Others may be damaged, which scipy says.
    """
    size = path.stat().st_size
    most, unpacked = max(_MOST if _is_plain(path) else _MOST_OF_PARTS, _MOST_PER_BYTE * size), 0
    elements = 0
    with path.open("rb") as file:
        head = file.read(_HEAD)
        order = ">" if head[126:128] == b"MI" else "<"
        while len(tag := file.read(_TAG)) == _TAG:
            kind, length = struct.unpack(f"{order}II", tag)
            end = file.tell() + length
            packed, variable = kind == _COMPRESSED, _Elements(order)
            for piece in _pieces(file, length, packed=packed):
                unpacked += len(piece) if packed else 0
                if unpacked > most:
                    raise LogError(
                        f"{path}: more than {most / 1e6:.0f} MB in a file of {size / 1e6:.3g} MB; "
                        "save it without compression (-v6), or in parts"
                    )
                for found in variable.kinds(piece):
                    elements += 1
                    if found not in _KINDS:
                        raise LogError(
                            f"{path}: damaged MAT file (no element is of the kind {found}); "
                            "save it again"
                        )
                if elements > _MOST_ELEMENTS:
                    raise LogError(
                        f"{path}: more than {_MOST_ELEMENTS} cells and fields; "
                        "save the columns as vectors"
                    )
            file.seek(end)


class _Elements:
    """The elements of one variable, which comes in pieces."""

    def __init__(self, order: str) -> None:
        self._tag = struct.Struct(f"{order}II")
        self._rest = b""  # begins with a tag
        self._skip = 0  # bytes of an element that are still to come

    def kinds(self, piece: bytes) -> Iterator[int]:
        """The kinds of the elements whose tags are complete with this piece."""
        if self._skip >= len(piece):
            self._skip -= len(piece)
            return
        data, at = self._rest + piece[self._skip :], 0
        while len(data) - at >= _TAG:
            kind, length = self._tag.unpack_from(data, at)
            at += _TAG
            if kind >> 16:  # up to four bytes in the tag itself
                kind &= 0xFFFF
            elif kind != _MATRIX:  # whose elements follow
                at += -(-length // 8) * 8
            yield kind
        self._rest, self._skip = data[at:], max(0, at - len(data))


def _pieces(file: IO[bytes], length: int, *, packed: bool) -> Iterator[bytes]:
    """The next bytes of a file, unpacked; up to where they are damaged."""
    unpack = zlib.decompressobj()
    try:
        while length > 0 and (piece := file.read(min(length, _PIECE))):
            length -= len(piece)
            if not packed:
                yield piece
            while packed and piece:
                yield unpack.decompress(piece, _AT_A_TIME)
                piece = unpack.unconsumed_tail
    except zlib.error:
        pass  # damaged, which scipy says in words


def _is_plain(path: Path) -> bool:
    """Whether all variables are arrays of numbers, so that the memory goes with the bytes."""
    import scipy.io

    try:
        return all(kind in _NUMBERS for _, _, kind in scipy.io.whosmat(path))
    except Exception:  # any: as for loadmat
        return False
