"""Values of eight floats ("lanes"), which kernels add and multiply by single instructions.

LLVM turns a plain loop over lanes into packed instructions only if it can prove that arrays do not
overlap, and the loop keeps the filter's state in memory between steps. A vector is one LLVM value
of eight doubles: it stays in registers, and every operation on it is packed. Each operation is an
IEEE operation in each lane, and the lanes do not affect each other.

In a sum or difference with a product, the product is not rounded first: `x + a * b` is always
IEEE's fused multiply-add, fma(a, b, x). So the result is the same on every machine and does not
depend on the compiler. (On a processor without this instruction, a slow function of the C library
is called.) In a sum of two products, the left product is rounded: `a * b + c * d` is
fma(c, d, a * b). For this purpose a product is a separate type that holds its two factors, even
when it is stored in a variable. Any use other than a sum or difference multiplies the factors;
`rounded(a * b)` multiplies them too and returns a vector.

A step of a filter waits for the previous step. A vector may therefore hold several groups of eight
lanes, with one instruction for each group. The processor works on one group while another group
waits, and the gains are read once for all groups.

In kernels the operators `+ - * /` take vectors and floats. The module `rows` loads and stores
vectors.
"""

from __future__ import annotations

import operator
from collections.abc import Sequence

from llvmlite import ir
from numba.core import cgutils, config, types
from numba.core.codegen import get_host_cpu_features
from numba.core.datamodel import models
from numba.core.imputils import lower_cast
from numba.core.typeconv import Conversion
from numba.core.typing.templates import ConcreteTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, register_model

from owtsweep.vectors import WIDTH

#: Whether the registers suffice for two groups of lanes at once: 32 registers of 512 bits do,
#: 16 registers of 256 bits do not.
ROOMY = "+avx512f" in (
    get_host_cpu_features() if config.CPU_FEATURES is None else config.CPU_FEATURES
)

#: Most groups of lanes that one vector holds.
PARTS = 3

#: LLVM's type of a group of lanes.
LANES = ir.VectorType(ir.DoubleType(), WIDTH)


class Grouped(types.Type):
    """A numba type of values that hold `parts` groups of eight lanes."""

    def __init__(self, name: str, parts: int) -> None:
        self.parts = parts
        super().__init__(name=f"{name}8x{parts}")


class _VectorType(Grouped):
    """The numba type of a vector."""


class _ProductType(Grouped):
    """The numba type of a product of two vectors: its two factors, not multiplied yet."""

    def can_convert_to(self, typingctx, other):
        return Conversion.safe if other is VECTORS[self.parts] else None


VECTORS = {parts: _VectorType("Vector", parts) for parts in range(1, PARTS + 1)}
PRODUCTS = {parts: _ProductType("Product", parts) for parts in range(1, PARTS + 1)}
VECTOR = VECTORS[1]


@register_model(_VectorType)
class _VectorModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.LiteralStructType([LANES] * kind.parts))


@register_model(_ProductType)
class _ProductModel(models.PrimitiveModel):
    def __init__(self, manager, kind):
        super().__init__(manager, kind, ir.LiteralStructType([LANES] * (2 * kind.parts)))


def join(builder: ir.IRBuilder, parts: Sequence[ir.Value], kind: ir.Type = LANES) -> ir.Value:
    """Combine LLVM values, either registers of eight lanes or addresses, into one value.

    Parameters
    ----------
    builder
        The builder of LLVM code.
    parts
        The values to combine.
    kind
        The LLVM type of each of these values.
    """
    value = ir.Constant(ir.LiteralStructType([kind] * len(parts)), ir.Undefined)
    for i, part in enumerate(parts):
        value = builder.insert_value(value, part, i)
    return value


def split(builder: ir.IRBuilder, kind: Grouped, value: ir.Value) -> list[ir.Value]:
    """Return the LLVM values that make up `value`: registers of eight lanes, or addresses.

    `kind` is the numba type of `value`: a vector or rows.
    """
    return [builder.extract_value(value, i) for i in range(kind.parts)]


@intrinsic
def rounded(typingctx, product):
    """Compute a product; return it as a vector, which several sums can use.

    `product` is the numba type of the product; numba passes `typingctx`.
    """
    if not isinstance(product, _ProductType):
        return None

    def codegen(context, builder, sig, args):
        return _cast(context, builder, product, VECTORS[product.parts], *args)

    return VECTORS[product.parts](product), codegen


def _spread(builder: ir.IRBuilder, kind: types.Type, value: ir.Value, parts: int) -> list[ir.Value]:
    """Return an operand as a list of LLVM registers, one for each group of eight lanes.

    A float is put into all lanes. The factors of a product are multiplied.

    Parameters
    ----------
    builder
        The builder of LLVM code.
    kind, value
        The operand: its numba type and its LLVM value.
    parts
        Number of groups, for a float.
    """
    if isinstance(kind, _VectorType):
        return split(builder, kind, value)
    if isinstance(kind, _ProductType):
        return [builder.fmul(*pair) for pair in _factors(builder, kind, value)]
    undefined = ir.Constant(LANES, ir.Undefined)
    lanes = ir.VectorType(ir.IntType(32), WIDTH)
    first = builder.insert_element(undefined, value, ir.Constant(ir.IntType(32), 0))
    return [builder.shuffle_vector(first, undefined, ir.Constant(lanes, [0] * WIDTH))] * parts


def _factors(
    builder: ir.IRBuilder, kind: Grouped, value: ir.Value
) -> list[tuple[ir.Value, ir.Value]]:
    """Return the factors of a product that has not been multiplied out yet.

    There is a pair of registers (left factor, right factor) for each group of eight lanes. `kind`
    is the product's numba type, and `value` is the product's LLVM value.
    """
    factors = [builder.extract_value(value, i) for i in range(2 * kind.parts)]
    return list(zip(factors[: kind.parts], factors[kind.parts :], strict=True))


def _fused(builder: ir.IRBuilder, a: ir.Value, b: ir.Value, c: ir.Value) -> ir.Value:
    """Return the LLVM value of a * b + c in eight lanes, rounded only once (fused multiply-add)."""
    kind = ir.FunctionType(LANES, [LANES] * 3)
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.fma.v{WIDTH}f64")
    return builder.call(function, [a, b, c])


def _sum(builder, sig, args, *, minus):
    parts = sig.return_type.parts
    (left, right), (first, second) = sig.args, args
    if isinstance(right, _ProductType):
        terms = _spread(builder, left, first, parts)
        pairs = _factors(builder, right, second)
        if minus:
            pairs = [(builder.fneg(a), b) for a, b in pairs]
    elif isinstance(left, _ProductType):
        terms = _spread(builder, right, second, parts)
        if minus:
            terms = [builder.fneg(term) for term in terms]
        pairs = _factors(builder, left, first)
    else:
        return _lane_by_lane(builder, builder.fsub if minus else builder.fadd, sig, args)
    fused = [_fused(builder, *pair, term) for pair, term in zip(pairs, terms, strict=True)]
    return join(builder, fused)


def _add(context, builder, sig, args):
    return _sum(builder, sig, args, minus=False)


def _subtract(context, builder, sig, args):
    return _sum(builder, sig, args, minus=True)


def _divide(context, builder, sig, args):
    return _lane_by_lane(builder, builder.fdiv, sig, args)


def _multiply(context, builder, sig, args):
    left, right = _operands(builder, sig, args)
    return join(builder, [*left, *right])


def _operands(builder, sig, args):
    """Return the registers of both operands: two lists with one register per group of eight lanes.

    `sig` holds the numba types of the operands and the result, `args` the operands' LLVM values.
    """
    pairs = zip(sig.args, args, strict=True)
    return [_spread(builder, *pair, sig.return_type.parts) for pair in pairs]


def _lane_by_lane(builder, operation, sig, args):
    pairs = zip(*_operands(builder, sig, args), strict=True)
    return join(builder, [operation(*pair) for pair in pairs])


def _define(function, codegen, results):
    pairs = [
        (result, left, right)
        for parts, result in results.items()
        for left in (VECTORS[parts], PRODUCTS[parts], types.float64)
        for right in (VECTORS[parts], PRODUCTS[parts], types.float64)
        if (left, right) != (types.float64, types.float64)
    ]

    @infer_global(function)
    class _Operator(ConcreteTemplate):
        cases = [signature(*pair) for pair in pairs]  # noqa: RUF012

    for _, *pair in pairs:
        lower_builtin(function, *pair)(codegen)


_define(operator.add, _add, VECTORS)
_define(operator.sub, _subtract, VECTORS)
_define(operator.mul, _multiply, PRODUCTS)
_define(operator.truediv, _divide, VECTORS)


def _cast(context, builder, source, target, value):
    return join(builder, _spread(builder, source, value, source.parts))


for _parts in VECTORS:
    lower_cast(PRODUCTS[_parts], VECTORS[_parts])(_cast)
