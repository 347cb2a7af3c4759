"""Load LLVM vectors from rows of eight floats in memory, and store vectors there.

`borrowed` makes rows from a tuple of C-contiguous arrays of shape (n, 8), one array per group of
eight lanes. `load(rows, i)` reads row i and `store(rows, i, vector)` writes row i, both without
bounds checks. `prefetch(rows, i)` fetches row i into the cache early. `zero(rows)` is a vector of
zeros. `groups` splits rows and vectors into groups of lanes. `element(array, i)` reads an element
of any other C-contiguous array, without bounds checks.
"""

from __future__ import annotations

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.types import containers
from numba.extending import intrinsic, register_model

from owtsweep.vectors import WIDTH
from owtsweep.vectors.vector import LANES, PARTS, VECTOR, VECTORS, Grouped, join, split

#: LLVM's type of an address.
POINTER = ir.PointerType()


class _RowsType(Grouped):
    """The numba type of rows: for each group of eight lanes, the address of the group's first row.

    Values of this type have no reference counts.
    """


ROWS = {parts: _RowsType("Rows", parts) for parts in range(1, PARTS + 1)}


@register_model(_RowsType)
class _RowsModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.LiteralStructType([POINTER] * kind.parts))


def _holds_rows(kind: types.Type) -> bool:
    if not isinstance(kind, types.Array):
        return False
    return bool(kind.ndim == 2 and kind.layout == "C" and kind.dtype == types.float64)


def borrowed_type(kind: types.Type) -> types.Type:
    """Return the numba type that `borrowed` makes of a value of the type `kind`."""
    if isinstance(kind, containers.UniTuple) and _holds_rows(kind.dtype):
        return ROWS[len(kind)]
    if isinstance(kind, containers.BaseNamedTuple):
        fields = [borrowed_type(field) for field in kind]
        kind = containers.NamedTuple(fields, kind.instance_class)
    return kind


def _borrow(context, builder, kind, value):
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        array.meminfo = cgutils.get_null_value(array.meminfo.type)
        array.parent = cgutils.get_null_value(array.parent.type)
        return array._getvalue()
    if not isinstance(kind, containers.BaseTuple):
        return value
    parts = list(zip(kind, cgutils.unpack_tuple(builder, value, len(kind)), strict=True))
    target = borrowed_type(kind)
    if isinstance(target, _RowsType):
        arrays = [context.make_array(one)(context, builder, part) for one, part in parts]
        return join(builder, [array.data for array in arrays], POINTER)
    fields = [_borrow(context, builder, one, part) for one, part in parts]
    return context.make_tuple(builder, target, fields)


@intrinsic
def borrowed(typingctx, value):
    """Return data for kernels without reference counts; the caller must keep the data alive.

    A tuple of arrays of shape (n, 8), one array for each group of eight lanes, becomes rows. Any
    other array, alone or in a named tuple, is returned without its owner. If an array had an owner,
    numba would update a reference count, in memory that all threads share, at every call and
    access. With many short calls these updates take as much time as the filter itself.
    """

    def codegen(context, builder, sig, args):
        return _borrow(context, builder, sig.args[0], args[0])

    return borrowed_type(value)(value), codegen


@intrinsic
def groups(typingctx, whole):
    """Split rows or a vector into groups of eight lanes; return a tuple with one item per group.

    `whole` is the numba type of the rows or the vector; numba passes `typingctx`.
    """

    rows = isinstance(whole, _RowsType)
    kind = whole if rows else VECTORS[whole.parts]
    alone, part = (ROWS[1], POINTER) if rows else (VECTOR, LANES)

    def codegen(context, builder, sig, args):
        parts = [join(builder, [one], part) for one in split(builder, kind, args[0])]
        return context.make_tuple(builder, sig.return_type, parts)

    return containers.UniTuple(alone, whole.parts)(kind), codegen


@intrinsic
def element(typingctx, array, i):
    """Return element number i, counted in memory order, of a C-contiguous array of any shape.

    There is no bounds check. numba's own indexing, with one index per dimension, must handle
    negative indices and unknown strides. For a row of a small matrix, this handling takes as much
    work as the sum that uses the row.
    """
    if array.layout != "C":
        return None

    def codegen(context, builder, sig, args):
        whole = context.make_array(sig.args[0])(context, builder, args[0])
        kind = context.get_data_type(array.dtype)
        address = builder.gep(whole.data, [args[1]], source_etype=kind)
        value = builder.load(address, typ=kind)
        return context.data_model_manager[array.dtype].from_data(builder, value)

    return array.dtype(array, types.intp), codegen


def _addresses(
    builder: ir.IRBuilder, kind: Grouped, rows: ir.Value, row: ir.Value
) -> list[ir.Value]:
    """Return the addresses of one row, one address for each group of eight lanes.

    Parameters
    ----------
    builder
        The builder of LLVM code.
    kind
        The numba type of `rows`.
    rows, row
        LLVM values: the rows, and the number of the row.
    """
    return [builder.gep(first, [row], source_etype=LANES) for first in split(builder, kind, rows)]


@intrinsic
def load(typingctx, rows, i):
    """Return a vector with row i of each group of eight lanes; there is no bounds check.

    numba passes `typingctx`.
    """

    def codegen(context, builder, sig, args):
        addresses = _addresses(builder, rows, *args)
        return join(builder, [builder.load(one, align=8, typ=LANES) for one in addresses])

    return VECTORS[rows.parts](rows, types.intp), codegen


@intrinsic
def store(typingctx, rows, i, vector):
    """Write a vector to row i of each group of eight lanes; there is no bounds check.

    numba passes `typingctx`.
    """
    kind = VECTORS[rows.parts]

    def codegen(context, builder, sig, args):
        addresses = _addresses(builder, rows, *args[:2])
        for part, address in zip(split(builder, kind, args[2]), addresses, strict=True):
            builder.store(part, address, align=8)
        return context.get_dummy_value()

    return types.void(rows, types.intp, kind), codegen


@intrinsic
def prefetch(typingctx, rows, i):
    """Fetch row i, which may be out of bounds, into the processor's second-level cache.

    The hardware fetches the next rows without being asked, but stops at the end of each page of
    memory, which holds 64 rows. The first-level cache is too small for all rows that are fetched so
    early.
    """

    def codegen(context, builder, sig, args):
        flag = ir.IntType(32)
        for address in _addresses(builder, rows, *args):
            kind = ir.FunctionType(ir.VoidType(), [POINTER, flag, flag, flag])
            function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
            builder.call(function, [address, flag(0), flag(2), flag(1)])
        return context.get_dummy_value()

    return types.void(rows, types.intp), codegen


@intrinsic
def zero(typingctx, rows):
    """Return a vector of zeros with as many groups of eight lanes as `rows` has.

    numba passes `typingctx`.
    """
    kind = VECTORS[rows.parts]

    def codegen(context, builder, sig, args):
        return join(builder, [ir.Constant(LANES, [0.0] * WIDTH)] * kind.parts)

    return kind(rows), codegen
