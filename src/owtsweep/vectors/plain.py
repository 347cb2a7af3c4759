"""Values of eight floats ("lanes") as tuples, for numba without LLVM vectors.

The functions and operators have the names and results of those in the modules `rows` and `vector`.
A value is a named tuple of floats, eight for each group of lanes. A product keeps its two factors
until it is added to something. Rows are tuples of arrays. Of numba and llvmlite, this module uses
only `numba.extending` and one instruction of llvmlite's builder, the fused multiply-add.

numba compiles one function for each combination of operand types. The source text of this function
is generated here, because numba can only make a tuple element by element.
"""

from __future__ import annotations

import operator
from typing import NamedTuple

from numba import types
from numba.extending import intrinsic, overload, register_jitable

from owtsweep.vectors import WIDTH

#: Whether registers hold two groups of lanes. Without vectors the order of work does not matter.
ROOMY = True


class Vector(NamedTuple):
    """A value of kernels: a tuple of floats, eight for each group of lanes."""

    lanes: tuple[float, ...]


class Product(NamedTuple):
    """A product that has not been computed yet: its two factors."""

    left: Vector
    right: Vector


@intrinsic
def fused(typingctx, a, b, c):
    """Return a * b + c for three floats, rounded only once (fused multiply-add).

    numba passes `typingctx`.
    """

    def codegen(context, builder, sig, args):
        return builder.fma(*args)

    return types.float64(types.float64, types.float64, types.float64), codegen


def _count(kind: types.Type) -> int:
    """Return the number of lanes of a numba type; 0 if it is neither a vector nor a product."""
    if not isinstance(kind, types.BaseNamedTuple):
        return 0
    if kind.instance_class is Product:
        return _count(kind[0])
    return len(kind[0]) if kind.instance_class is Vector else 0


def _is_product(kind: types.Type) -> bool:
    return _count(kind) > 0 and kind.instance_class is Product


def _lane(kind: types.Type, name: str) -> str:
    """Return source text for one lane of an operand; `{i}` stands for the number of the lane.

    For a product, the text multiplies the two factors. For a float, the text is only the name.

    Parameters
    ----------
    kind
        The numba type of the operand: a vector, a product or a float.
    name
        The operand's name in the source text.
    """
    if _is_product(kind):
        return f"({name}.left.lanes[{{i}}] * {name}.right.lanes[{{i}}])"
    return f"{name}.lanes[{{i}}]" if _count(kind) else name


def _vector(text: str, lanes: range) -> str:
    return f"Vector(({' '.join(text.format(i=i) + ',' for i in lanes)}))"


def _function(parameters, body):
    scope = {"__name__": __name__, "Vector": Vector, "Product": Product, "fused": fused}
    exec(f"def function({parameters}):\n    {body}", scope)
    return scope["function"]


def _define(function, text):
    """Define a Python operator, e.g. `operator.add`, for vectors, products and floats in numba.

    Parameters
    ----------
    function
        The operator.
    text
        Function of the numba types of both operands that returns source text for one lane of the
        result; `{i}` in the text stands for the lane's number.
    """

    @overload(function, jit_options={"error_model": "numpy"})
    def implementation(a, b):
        count = max(_count(a), _count(b))
        if not count:
            return None
        return _function("a, b", f"return {_vector(text(a, b), range(count))}")


def _sum(a: types.Type, b: types.Type, sign: str) -> str:
    if _is_product(b):
        return f"fused({sign}b.left.lanes[{{i}}], b.right.lanes[{{i}}], {_lane(a, 'a')})"
    if _is_product(a):
        return f"fused(a.left.lanes[{{i}}], a.right.lanes[{{i}}], {sign}{_lane(b, 'b')})"
    return f"{_lane(a, 'a')} + {sign}{_lane(b, 'b')}"


_define(operator.add, lambda a, b: _sum(a, b, ""))
_define(operator.sub, lambda a, b: _sum(a, b, "-"))
_define(operator.truediv, lambda a, b: f"{_lane(a, 'a')} / {_lane(b, 'b')}")


@overload(operator.mul)
def _multiply(a, b):
    count = max(_count(a), _count(b))
    if not count:
        return None
    left, right = (_vector(_lane(*operand), range(count)) for operand in ((a, "a"), (b, "b")))
    return _function("a, b", f"return Product({left}, {right})")


def rounded(product):
    """Compute a product; return it as a vector, which several sums can use."""


def borrowed_type(kind: types.Type) -> types.Type:
    """Return the numba type that `borrowed` makes of a value of the type `kind`: the same type."""
    return kind


@register_jitable
def borrowed(value):
    """Return data unchanged; with LLVM vectors, `rows.borrowed` removes the reference counts."""
    return value


def groups(whole):
    """Split rows or a vector into groups of eight lanes; return a tuple with one item per group."""


def element(array, i):
    """Return element number i, counted in memory order, of a C-contiguous array of any shape."""


def load(rows, i):
    """Return a vector with row i of each array in `rows`; each array is a group of eight lanes."""


def store(rows, i, vector):
    """Write a vector to row i of the arrays in `rows`; each array is a group of eight lanes."""


@register_jitable
def prefetch(rows, i):
    """Do nothing; with LLVM vectors, the function `rows.prefetch` fetches row i into the cache."""


def zero(rows):
    """Return a vector of zeros with one group of eight lanes for each array in `rows`."""


@overload(rounded)
def _rounded(product):
    return _function(
        "product", f"return {_vector(_lane(product, 'product'), range(_count(product)))}"
    )


@overload(groups)
def _groups(whole):
    count = _count(whole)
    if not count:
        alone = [f"(whole[{g}],)" for g in range(len(whole))]
    else:
        alone = [
            _vector(_lane(whole, "whole"), range(first, first + WIDTH))
            for first in range(0, count, WIDTH)
        ]
    return _function("whole", f"return ({' '.join(one + ',' for one in alone)})")


@overload(element)
def _element(array, i):
    if array.layout != "C":
        return None
    return lambda array, i: array.ravel()[i]


@overload(load)
def _load(rows, i):
    lanes = [f"rows[{g}][i, {lane}]," for g in range(len(rows)) for lane in range(WIDTH)]
    return _function("rows, i", f"return Vector(({' '.join(lanes)}))")


@overload(store)
def _store(rows, i, vector):
    value = _lane(vector, "vector")
    written = [
        f"rows[{g}][i, {lane}] = {value.format(i=WIDTH * g + lane)}"
        for g in range(len(rows))
        for lane in range(WIDTH)
    ]
    return _function("rows, i, vector", "; ".join(written))


@overload(zero)
def _zero(rows):
    return _function("rows", f"return {_vector('0.0', range(WIDTH * len(rows)))}")
