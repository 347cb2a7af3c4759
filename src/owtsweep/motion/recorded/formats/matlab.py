"""Read MATLAB files (.mat): arrays of real numbers alone, so nothing in a file can run code.

h5py reads those of version 7.3. SciPy reads those of versions 4 to 7 too, but a damaged one ends
the process (1.17: a segmentation fault where numbers are of an unknown type). So they are read
here, after the MathWorks' "MAT-File Format", and all that is wrong with one is told in one line.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Iterator
from functools import partial
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.recorded.formats.arrays import Variable, open_arrays
from owtsweep.motion.recorded.formats.hdf5 import list_arrays
from owtsweep.motion.recorded.formats.table import ChannelTable, refuse_damaged

#: Types of data elements that hold numbers, and those that hold a compressed element or an array.
TYPES = {
    1: "i1", 2: "u1", 3: "i2", 4: "u2", 5: "i4", 6: "u4", 7: "f4", 9: "f8", 12: "i8", 13: "u8",
}  # fmt: skip
MATRIX, COMPRESSED = 14, 15
#: Classes of arrays of plain numbers: double, single, integers (logical ones among them).
NUMBERS = range(6, 16)
COMPLEX = 0x0800
#: Precisions of version 4.
OLD = {0: "f8", 1: "f4", 2: "i4", 3: "i2", 4: "u2", 5: "u1"}
#: Bytes in which class, shape and name of an array stand.
HEAD = 4096
#: The beginning of an HDF5 file, which MATLAB 7.3 puts behind a header of its own.
HDF5, HEADER = b"\x89HDF\r\n\x1a\n", 512


#: What is said of a damaged file, and the errors that reading one raises.
DAMAGED = ("is not a whole MATLAB file", ValueError, struct.error, zlib.error)


def list_variables(path: Path) -> Iterator[Variable]:
    """Yield the variables of a file of versions 4 to 7; read none of their numbers."""
    with path.open("rb") as file:
        header = file.read(128)
        order = {b"IM": "<", b"MI": ">"}.get(header[126:])
        if order is None or 0 in header[:4]:
            yield from _list_old(path)
            return
        size, place = path.stat().st_size, 128
        while place < size:
            file.seek(place)
            kind, length = struct.unpack(order + "II", file.read(8))
            if place + 8 + length > size:
                raise ValueError("it ends inside a variable")
            raw = file.read(min(length, HEAD))
            if kind == COMPRESSED:
                raw = zlib.decompressobj().decompress(raw, HEAD)
                if struct.unpack(order + "I", raw[:4])[0] != MATRIX:
                    raise ValueError("a compressed element is no array")
                raw = raw[8:]
            if kind in (MATRIX, COMPRESSED):
                name, shape, real = _read_head(raw, order)[:3]
                at = (place + 8, length, kind == COMPRESSED)
                load = partial(_load, path, name, shape, order, at)
                yield Variable(name, shape, real, load)
            place += 8 + length


def _load(
    path: Path, name: str, shape: tuple[int, ...], order: str, at: tuple[int, int, bool]
) -> Array:
    begin, length, packed = at
    raw = _read(path, begin, length)
    if packed:
        raw = zlib.decompressobj().decompress(raw, HEAD + 8 * math.prod(shape))[8:]
    type_, begin, size, _ = _read_tag(raw, _read_head(raw, order)[3], order)
    if type_ not in TYPES:
        raise ValueError(f"{name} has numbers of the unknown type {type_}")
    values = np.frombuffer(raw[begin : begin + size], order + TYPES[type_])
    return values.astype(float).reshape(shape, order="F")


def _read(path: Path, begin: int, length: int) -> bytes:
    with path.open("rb") as file:
        file.seek(begin)
        return file.read(length)


def _list_old(path: Path) -> Iterator[Variable]:
    size, place = path.stat().st_size, 0
    while place < size:
        head = _read(path, place, 20 + HEAD)
        order = "<" if 0 <= struct.unpack("<i", head[:4])[0] <= 9999 else ">"
        code, rows, columns, imaginary, letters = struct.unpack(order + "5i", head[:20])
        machine, precision, kind = code // 1000, code // 10 % 10, code % 10
        if (
            machine != (order == ">") or code // 100 % 10 or precision not in OLD or kind > 2
            or min(rows, columns) < 0 or imaginary not in (0, 1) or not 1 < letters <= HEAD
        ):  # fmt: skip
            raise ValueError("its header is none of MATLAB's")
        name = head[20 : 20 + letters].rstrip(b"\0").decode("latin-1")
        length = rows * columns * np.dtype(OLD[precision]).itemsize
        begin = place + 20 + letters
        place = begin + length * (1 + imaginary)
        if place > size:
            raise ValueError("it ends inside a variable")
        load = partial(_load_old, path, (rows, columns), order + OLD[precision], begin)
        yield Variable(name, (rows, columns), kind == 0 and not imaginary, load)


def _load_old(path: Path, shape: tuple[int, int], kind: str, begin: int) -> Array:
    values = np.fromfile(path, kind, math.prod(shape), offset=begin)
    return values.astype(float).reshape(shape, order="F")


def _read_head(raw: bytes, order: str) -> tuple[str, tuple[int, ...], bool, int]:
    _, begin, size, place = _read_tag(raw, 0, order)
    flags = struct.unpack(order + "I", raw[begin : begin + 4])[0]
    real = (flags & 0xFF) in NUMBERS and not flags & COMPLEX
    if (flags & 0xFF) == 17:  # opaque, e.g. a table or a string: neither shape nor name follow
        return "an object", (), False, place
    _, begin, size, place = _read_tag(raw, place, order)
    shape = struct.unpack(f"{order}{size // 4}i", raw[begin : begin + size])
    _, begin, size, place = _read_tag(raw, place, order)
    if min(shape, default=-1) < 0:
        raise ValueError("an array has no shape")
    return raw[begin : begin + size].decode("latin-1"), shape, real, place


def _read_tag(raw: bytes, place: int, order: str) -> tuple[int, int, int, int]:
    first, size = struct.unpack(order + "II", raw[place : place + 8])
    if first >> 16:  # a short element: type, size and up to four bytes of data in eight
        return first & 0xFFFF, place + 4, min(first >> 16, 4), place + 8
    return first, place + 8, size, place + 8 + -(-size // 8) * 8


def open_mat(path: Path) -> ChannelTable:
    """Open a MATLAB file.

    Vectors and matrices become channels as in `arrays.open_arrays`, the longer side of a matrix
    being time. A number that stands alone is left out.

    Raises InputError if the file is damaged, or as `open_arrays`.
    """
    begin = _read(path, 0, HEADER + len(HDF5))
    with refuse_damaged(path, *DAMAGED):
        is_hdf5 = begin.startswith((b"MATLAB 7.3", HDF5)) or begin[HEADER:] == HDF5
        variables = [*(list_arrays(path) if is_hdf5 else list_variables(path))]
    return open_arrays(path, "MATLAB", map(_put_time_first, variables), DAMAGED)


def _put_time_first(variable: Variable) -> Variable:
    shape = variable.shape
    if len(shape) != 2 or min(shape) < 1 or max(shape) < 2:
        return variable._replace(real=False)
    turned = (max(shape),) if min(shape) == 1 else (max(shape), min(shape))
    if shape[0] >= shape[1]:
        return variable._replace(shape=turned)
    return variable._replace(shape=turned, load=lambda: variable.load().T)
