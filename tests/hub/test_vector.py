"""Vectors of lanes: what is fused and what is rounded, against exact arithmetic, on any machine."""

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
from owtsweep.vectors.memory import borrowed, element, groups, load, store
from owtsweep.vectors.vector import rounded

ELSEWHERE = "OWTSWEEP_TEST_GENERIC_PROCESSOR"
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
    sometimes = a * b
    if more:
        sometimes = sometimes + c * d
    store(target, 13, sometimes)


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
@pytest.mark.parametrize("parts", [1, 2, 3])
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
    if ELSEWHERE in os.environ:
        assert not any("vfmadd" in text for text in _evaluated.inspect_asm().values())


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


@pytest.mark.skipif(ELSEWHERE in os.environ, reason="this is the other processor")
def test_bits_are_those_of_a_processor_without_fused_instructions(tmp_path: Path) -> None:
    changes = {ELSEWHERE: "1", "NUMBA_CPU_NAME": "generic", "NUMBA_CACHE_DIR": str(tmp_path)}
    mine = {
        k: v for k, v in os.environ.items() if k not in ("NUMBA_CPU_FEATURES", "PYTEST_ADDOPTS")
    }
    command = [sys.executable, "-m", "pytest", "-p", "no:xdist", "-p", "no:cacheprovider"]
    done = subprocess.run(
        [*command, __file__], env={**mine, **changes}, capture_output=True, text=True
    )
    assert done.returncode == 0, done.stdout
    assert "13 passed, 1 skipped" in done.stdout
