"""Values of eight lanes: what is fused and what is rounded, in both forms, on any machine."""

from __future__ import annotations

import os
import subprocess
import sys
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest
from numba import TypingError
from numpy.typing import NDArray

from owtsweep.arrays import aligned
from owtsweep.compiled import njit
from owtsweep.errors import InputError
from owtsweep.vectors import choose, uses_vectors

#: In which of `ELSEWHERE` this very process runs; a test starts one for each of them.
HERE = os.environ.get("OWTSWEEP_TEST_LANES", "")
choose(HERE != "plain loops")

from owtsweep.vectors.lanes import borrowed, element, groups, load, rounded, store  # noqa: E402

#: Environment variables, and how many tests pass and are skipped.
ELSEWHERE = {
    "no fused instructions": ({"NUMBA_CPU_NAME": "generic"}, "15 passed, 1 skipped"),
    "no typed pointers": ({"LLVMLITE_ENABLE_IR_LAYER_TYPED_POINTERS": "0"}, "15 passed, 1 skipped"),
    "plain loops": ({}, "10 passed, 2 skipped"),
}
NAMES = (
    "x + a * b", "a * b + x", "x - a * b", "a * b - x", "a * b + c * d", "a * b - c * d", "a * b",
    "a * b * c", "a * b / c", "f * a + x", "f - a * b", "x + a - b", "x + (a * b + c * d)",
    "in a branch", "in groups", "returned", "in a loop", "x + rounded(a * b)",
)  # fmt: skip


@njit
def _pair(a, b):
    return a, a * b


@njit
def _evaluated(values, f, more, found):
    rows, target = borrowed(values), borrowed(found)
    x, a, b = load(rows, 0), load(rows, 1), load(rows, 2)
    c, d = load(rows, 3), load(rows, 4)
    store(target, 0, x + a * b)
    store(target, 1, a * b + x)
    store(target, 2, x - a * b)
    store(target, 3, a * b - x)
    store(target, 4, a * b + c * d)
    store(target, 5, a * b - c * d)
    store(target, 6, a * b)
    store(target, 7, a * b * c)
    store(target, 8, a * b / c)
    store(target, 9, f * a + x)
    store(target, 10, f - a * b)
    store(target, 11, x + a - b)
    store(target, 12, x + (a * b + c * d))
    for g, one in enumerate(groups(a * b)):
        store(groups(target)[g], 14, one)
    left, right = _pair(a, b)
    store(target, 15, left + right)
    kept = a * b
    for _ in range(2):
        x = x + kept
        kept = c * d
    store(target, 16, x)
    store(target, 17, load(rows, 0) + rounded(a * b))
    both = a * b + c * d
    store(target, 13, both if more else rounded(a * b))


@njit
def _sometimes_a_product(values, more, found):
    rows = borrowed(values)
    sometimes = load(rows, 1) * load(rows, 2)
    if more:
        sometimes = sometimes + load(rows, 3) * load(rows, 4)
    store(borrowed(found), 0, sometimes)


def fma(a: float, b: float, c: float) -> float:
    return float(Fraction(a) * Fraction(b) + Fraction(c))


def _exact(x: float, a: float, b: float, c: float, d: float, f: float, more: bool) -> list[float]:
    both = fma(c, d, a * b)
    return [
        fma(a, b, x), fma(a, b, x), fma(-a, b, x), fma(a, b, -x), both, fma(-c, d, a * b), a * b,
        a * b * c, a * b / c, fma(f, a, x), fma(-a, b, f), x + a - b, x + both,
        both if more else a * b, a * b, fma(a, b, a), fma(c, d, fma(a, b, x)), x + a * b,
    ]  # fmt: skip


@pytest.mark.parametrize("more", [False, True])
@pytest.mark.parametrize("parts", [1, 2, 3] if uses_vectors() else [2])
def test_products_are_fused_with_what_they_are_added_to(parts: int, more: bool) -> None:
    draw = np.random.default_rng(parts)
    values = tuple(aligned(5, 8) for _ in range(parts))
    found = tuple(aligned(len(NAMES), 8) for _ in range(parts))
    for rows in values:
        rows[...] = draw.normal(size=rows.shape)
        rows[0] = -rows[1] * rows[2] * (1 + 1e-15)  # so that a rounded product shows
    f = float(draw.normal())
    _evaluated(values, f, more, found)
    for rows, own in zip(values, found, strict=True):
        expected = np.array([_exact(*lane, f, more) for lane in rows.T.tolist()]).T
        for name, one, other in zip(NAMES, own, expected, strict=True):
            np.testing.assert_array_equal(one, other, err_msg=name)
    assert not _all_rounded(values[0], found[0])
    if HERE == "no fused instructions":
        assert not any("vfmadd" in text for text in _evaluated.inspect_asm().values())


@pytest.mark.skipif(not uses_vectors(), reason="the plain form has no such conversion")
def test_a_product_is_a_vector_where_a_branch_makes_it_one() -> None:
    values, found = (aligned(5, 8),), (aligned(1, 8),)
    values[0][...] = np.random.default_rng(1).normal(size=(5, 8))
    for more in (False, True):
        _sometimes_a_product(values, more, found)
        expected = [_exact(*lane, 0.0, more)[13] for lane in values[0].T.tolist()]
        np.testing.assert_array_equal(found[0][0], expected)


def test_the_form_stays_once_kernels_are_imported() -> None:
    with pytest.raises(InputError, match=r"compute\.vectors: this process has already compiled"):
        choose(not uses_vectors())
    choose(uses_vectors())


@njit
def _elements(array, count):
    return [element(array, i) for i in range(count)]


@pytest.mark.parametrize("kind", [np.float64, np.bool_])
@pytest.mark.parametrize("shape", [(24,), (8, 3), (2, 4, 3)])
def test_elements_count_as_they_lie(kind: type, shape: tuple[int, ...]) -> None:
    array = np.random.default_rng(1).normal(size=24) > 0.0 if kind is np.bool_ else np.arange(24.0)
    assert _elements(array.reshape(shape), 24) == list(array)


def test_elements_of_what_does_not_lie_in_one_piece_are_refused() -> None:
    with pytest.raises(TypingError):
        _elements(np.arange(24.0)[::2], 12)


def _all_rounded(rows: NDArray[np.float64], found: NDArray[np.float64]) -> bool:
    """Whether the numbers would not tell a fused from a rounded product."""
    x, a, b = rows[:3]
    return bool(np.array_equal(found[0], x + a * b))


@pytest.mark.skipif(HERE != "", reason="this is such a process")
@pytest.mark.parametrize(
    "where",
    [
        "no fused instructions",
        pytest.param("no typed pointers", marks=pytest.mark.faults),
        pytest.param("plain loops", marks=pytest.mark.faults),
    ],
)
def test_bits_are_the_same(where: str, tmp_path: Path) -> None:
    changes, outcome = ELSEWHERE[where]
    others = ("NUMBA_CPU_FEATURES", "PYTEST_ADDOPTS")
    mine = {name: value for name, value in os.environ.items() if name not in others}
    here = {"OWTSWEEP_TEST_LANES": where, "NUMBA_CACHE_DIR": str(tmp_path)}
    command = [sys.executable, "-m", "pytest", "-p", "no:xdist", "-p", "no:cacheprovider"]
    done = subprocess.run(
        [*command, __file__], env={**mine, **changes, **here}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout
    assert outcome in done.stdout
