"""A value of eight lanes: what the kernels add and multiply, one instruction at a time.

LLVM turns a plain loop over lanes into packed instructions only where it can prove that arrays do
not overlap, and keeps the state in memory between steps. A `Vector` is one LLVM value of eight
doubles: it stays in registers, and every operation on it is packed. Lanes never meet, and each
operation is the IEEE operation of its lane, so the bits are those of a loop over lanes.

Inside kernels: `load(rows, i)` and `store(rows, i, vector)` move row i of a C-contiguous (n, 8)
array, unchecked; `prefetch(rows, i)` asks for one early; `zero()` is eight zeros; `+ - * /` take
vectors and floats.
"""

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.core.datamodel import models
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, register_model

#: Lanes of a vector: one 512-bit register, two of 256 bits, four of 128.
WIDTH = 8

#: Rows ahead of their use that streams from memory are asked for.
AHEAD = 32

_DOUBLE = ir.DoubleType()
_LLVM = ir.VectorType(_DOUBLE, WIDTH)


class _VectorType(types.Type):
    def __init__(self) -> None:
        super().__init__(name="Vector8")


VECTOR = _VectorType()


@register_model(_VectorType)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, _LLVM)


def _address(context: Any, builder: Any, array_type: Any, array: Any, row: Any) -> Any:
    data = context.make_array(array_type)(context, builder, array).data
    first = builder.mul(row, ir.Constant(row.type, WIDTH))
    return builder.bitcast(builder.gep(data, [first]), _LLVM.as_pointer())


def _check(array: Any) -> None:
    whole = isinstance(array, types.Array) and array.ndim == 2 and array.layout == "C"
    if not whole or array.dtype != types.float64:
        raise TypeError(f"rows of lanes are C-contiguous (n, {WIDTH}) doubles, not {array}")


@intrinsic
def load(typingctx: Any, rows: Any, i: Any) -> Any:
    """Row i of an (n, 8) array."""
    _check(rows)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.load(_address(context, builder, sig.args[0], *args), align=8)

    return VECTOR(rows, types.intp), codegen


@intrinsic
def store(typingctx: Any, rows: Any, i: Any, vector: Any) -> Any:
    """Write a vector to row i of an (n, 8) array."""
    _check(rows)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        builder.store(args[2], _address(context, builder, sig.args[0], *args[:2]), align=8)
        return context.get_dummy_value()

    return types.void(rows, types.intp, VECTOR), codegen


@intrinsic
def prefetch(typingctx: Any, rows: Any, i: Any) -> Any:
    """Ask for row i, which may lie outside, before it is needed.

    The hardware foresees the next rows of a stream but stops at each page, every 64 rows.
    """
    _check(rows)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        address = _address(context, builder, sig.args[0], *args)
        address = builder.bitcast(address, ir.IntType(8).as_pointer())
        flag = ir.IntType(32)
        kind = ir.FunctionType(ir.VoidType(), [address.type, flag, flag, flag])
        function = cgutils.get_or_insert_function(builder.module, kind, "llvm.prefetch.p0")
        builder.call(function, [address, flag(0), flag(3), flag(1)])
        return context.get_dummy_value()

    return types.void(rows, types.intp), codegen


@intrinsic
def zero(typingctx: Any) -> Any:
    """Eight zeros."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return ir.Constant(_LLVM, [0.0] * WIDTH)

    return VECTOR(), codegen


def _spread(builder: Any, value: Any) -> Any:
    """A float in all lanes; a vector as it is."""
    if value.type == _LLVM:
        return value
    undefined = ir.Constant(_LLVM, ir.Undefined)
    lanes = ir.VectorType(ir.IntType(32), WIDTH)
    first = builder.insert_element(undefined, value, ir.Constant(ir.IntType(32), 0))
    return builder.shuffle_vector(first, undefined, ir.Constant(lanes, [0] * WIDTH))


def _define(function: Any, instruction: str) -> None:
    pairs = ((VECTOR, VECTOR), (types.float64, VECTOR), (VECTOR, types.float64))

    @infer_global(function)
    class _Operator(ConcreteTemplate):
        cases = [signature(VECTOR, *pair) for pair in pairs]  # noqa: RUF012

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        left, right = (_spread(builder, value) for value in args)
        return getattr(builder, instruction)(left, right)

    for pair in pairs:
        lower_builtin(function, *pair)(codegen)


for _function, _instruction in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _define(_function, _instruction)
