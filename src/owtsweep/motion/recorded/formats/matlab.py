"""Read MATLAB files (.mat) of versions 4 to 7: arrays of real numbers alone.

Structures, cells, objects and functions are never loaded, so nothing in a file can run code. The
layout is after the MathWorks' "MAT-File Format". SciPy reads these files as well, but a damaged one
ends the process (1.17: a segmentation fault where numbers are of an unknown type). So what a
stranger sends is read here, and all that is wrong with it is `Damaged`.
"""

from __future__ import annotations

import math
import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.recorded.formats.arrays import name_columns
from owtsweep.motion.recorded.formats.table import (
    ChannelTable,
    refuse,
    refuse_damaged,
    require_room,
)

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


class Damaged(Exception):
    """A file is not what its format says; the message is what is wrong."""


@dataclass(frozen=True)
class Variable:
    """A variable of a file."""

    name: str
    shape: tuple[int, ...]
    real: bool  # whether it is an array of real numbers
    begin: int  # where its element begins in the file; of version 4, where its numbers begin
    size: int  # bytes there
    packed: bool
    order: str  # "<" or ">"
    kind: str = ""  # type of the numbers of version 4; later ones say it at the numbers


def list_variables(path: Path) -> list[Variable]:
    """Return the variables of a file; read none of their numbers."""
    with path.open("rb") as file:
        header = file.read(128)
    order = {b"IM": "<", b"MI": ">"}.get(header[126:])
    if order is None or 0 in header[:4]:
        return _list_old(path)
    size, place = path.stat().st_size, 128
    found = []
    with path.open("rb") as file:
        while place < size:
            file.seek(place)
            kind, length = _unpack(order + "II", file.read(8))
            if place + 8 + length > size:
                raise Damaged("it ends inside a variable")
            raw = file.read(min(length, HEAD))
            if kind == COMPRESSED:
                raw = _inflate(raw, HEAD)
                if _unpack(order + "I", raw[:4])[0] != MATRIX:
                    raise Damaged("a compressed element is no array")
                raw = raw[8:]
            if kind in (MATRIX, COMPRESSED):
                name, shape, real = _read_head(raw, order)[:3]
                found.append(
                    Variable(name, shape, real, place + 8, length, kind == COMPRESSED, order)
                )
            place += 8 + length
    return found


def load_variable(path: Path, variable: Variable) -> Array:
    """Return the numbers of a variable of two dimensions, an array of shape `variable.shape`."""
    count = math.prod(variable.shape)
    with path.open("rb") as file:
        file.seek(variable.begin)
        raw = file.read(variable.size)
    kind = variable.order + variable.kind
    if not variable.kind:
        if variable.packed:
            raw = _inflate(raw, HEAD + 8 * count)[8:]
        begin = _read_head(raw, variable.order)[3]
        type_, begin, size, _ = _read_tag(raw, begin, variable.order)
        if type_ not in TYPES:
            raise Damaged(f"{variable.name} has numbers of the unknown type {type_}")
        kind = variable.order + TYPES[type_]
        raw = raw[begin : begin + size]
    if len(raw) != count * np.dtype(kind).itemsize:
        raise Damaged(f"{variable.name} does not hold {count} numbers")
    return np.frombuffer(raw, kind).astype(float).reshape(variable.shape, order="F")


def _list_old(path: Path) -> list[Variable]:
    size, place = path.stat().st_size, 0
    found = []
    with path.open("rb") as file:
        while place < size:
            file.seek(place)
            head = file.read(20)
            order = "<" if 0 <= _unpack("<i", head[:4])[0] <= 9999 else ">"
            code, rows, columns, imaginary, letters = _unpack(order + "5i", head)
            machine, precision, kind = code // 1000, code // 10 % 10, code % 10
            if (
                machine != (order == ">") or code // 100 % 10 or precision not in OLD or kind > 2
                or min(rows, columns) < 0 or imaginary not in (0, 1) or not 1 < letters <= HEAD
            ):  # fmt: skip
                raise Damaged("its header is none of MATLAB's")
            name = file.read(letters).rstrip(b"\0").decode("latin-1")
            length = rows * columns * np.dtype(OLD[precision]).itemsize
            begin = place + 20 + letters
            place = begin + length * (1 + imaginary)
            if place > size:
                raise Damaged("it ends inside a variable")
            real = kind == 0 and not imaginary
            found.append(
                Variable(name, (rows, columns), real, begin, length, False, order, OLD[precision])
            )
    return found


def _read_head(raw: bytes, order: str) -> tuple[str, tuple[int, ...], bool, int]:
    _, begin, size, place = _read_tag(raw, 0, order)
    flags = _unpack(order + "I", raw[begin : begin + 4])[0]
    real = (flags & 0xFF) in NUMBERS and not flags & COMPLEX
    if (flags & 0xFF) == 17:  # opaque, e.g. a table or a string: neither shape nor name follow
        return "an object", (), False, place
    _, begin, size, place = _read_tag(raw, place, order)
    shape = _unpack(f"{order}{size // 4}i", raw[begin : begin + size])
    _, begin, size, place = _read_tag(raw, place, order)
    if min(shape, default=-1) < 0:
        raise Damaged("an array has no shape")
    return raw[begin : begin + size].decode("latin-1"), shape, real, place


def _read_tag(raw: bytes, place: int, order: str) -> tuple[int, int, int, int]:
    first, size = _unpack(order + "II", raw[place : place + 8])
    if first >> 16:  # a short element: type, size and up to four bytes of data in eight
        return first & 0xFFFF, place + 4, min(first >> 16, 4), place + 8
    return first, place + 8, size, place + 8 + -(-size // 8) * 8


def _inflate(raw: bytes, most: int) -> bytes:
    try:
        return zlib.decompressobj().decompress(raw, most)
    except zlib.error as error:
        raise Damaged(str(error)) from None


def _unpack(layout: str, raw: bytes) -> tuple[int, ...]:
    try:
        return struct.unpack(layout, raw)
    except struct.error as error:
        raise Damaged(str(error)) from None


def open_mat(path: Path) -> ChannelTable:
    """Open a MATLAB file.

    A vector `a` becomes the channel a. The longer side of a matrix is time; its columns become
    channels as in `arrays.open_npz`. What is no array of real numbers, or stands alone, is left
    out.

    Raises InputError if the file is damaged or has no array of numbers; when numbers are loaded, if
        channels differ in length.
    """
    _refuse_hdf5(path)
    places: dict[str, tuple[Variable, int]] = {}  # channel -> variable, column
    left_out = []
    with refuse_damaged(path, "is not a whole MATLAB file", Damaged):
        variables = list_variables(path)
    for variable in variables:
        shape = variable.shape
        if not variable.real or len(shape) != 2 or min(shape) < 1 or max(shape) < 2:
            left_out.append(variable.name)
            continue
        require_room(path, max(shape), min(shape), max(shape))
        name, columns = variable.name, min(shape)
        channels = [name] if columns == 1 else name_columns(path, name, columns)
        places.update({each: (variable, column) for column, each in enumerate(channels)})
    listed = f"no arrays of real numbers, left out: {', '.join(left_out)}" if left_out else ""
    if not places:
        raise refuse(
            path, f"has no vector of numbers: save plain vectors{listed and f' ({listed})'}"
        )

    def load(names: Sequence[str], rows: int | None) -> Mapping[str, Array]:
        lengths = {name: max(places[name][0].shape) for name in names}
        if len(set(lengths.values())) > 1:
            told = ", ".join(f"{name} {length}" for name, length in lengths.items())
            raise refuse(path, f"channels differ in length ({told}): save them equally long")
        result: dict[str, Array] = {}
        for variable in dict.fromkeys(places[name][0] for name in names):
            with refuse_damaged(path, "is not a whole MATLAB file", Damaged):
                array = load_variable(path, variable)
            table = array if array.shape[0] >= array.shape[1] else array.T
            for name in names:
                if places[name][0] == variable:
                    result[name] = np.array(table[:rows, places[name][1]])
        return result

    longest = max(max(variable.shape) for variable, _ in places.values())
    units, notes = ("",) * len(places), [listed] if listed else []
    return ChannelTable(path, "MATLAB", tuple(places), units, load, longest, notes)


def _refuse_hdf5(path: Path) -> None:
    with path.open("rb") as file:
        begin = file.read(HEADER + len(HDF5))
    if begin.startswith((b"MATLAB 7.3", HDF5)) or begin[HEADER:] == HDF5:
        raise refuse(
            path,
            "is of MATLAB's version 7.3 (HDF5), which is not read: save it again with "
            "save('NAME.mat', 'time', 'x', ..., '-v7'), or convert it to CSV",
        )
