"""Says in a sentence or two per cell what the values of a key change."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.base.varying.errors import Errors

#: Errors that differ by less than this fraction are called equal.
LEAST_CHANGE = 0.005


def answer_each(errors: Errors) -> Iterator[str]:
    """Yield for each cell the sentences on the best scheme and the bound, and the further ones."""
    least = find_least(errors)
    for number, cell in enumerate(errors.cells):
        parts = [_follow_best(errors, number, least[:, number])]
        parts += errors.further[number] if errors.further else ()
        start = f"At {cell}: " if len(errors.cells) > 1 else ""
        yield start + " ".join(parts)


def find_least(errors: Errors) -> Array:
    """Return the best scheme's error, shape (values, cells); NaN where no scheme has one."""
    of_schemes = errors.error[: len(errors.schemes)]
    least = np.where(np.isfinite(of_schemes), of_schemes, np.inf).min(axis=0)
    return np.where(np.isfinite(least), least, np.nan)


def find_ends(errors: Errors, least: Array) -> tuple[int, int]:
    """Return the indices of two values to compare: the ends, or with texts the extremes."""
    if isinstance(errors.values[0], str):
        return int(np.nanargmin(least)), int(np.nanargmax(least))
    return 0, len(errors.values) - 1


def _follow_best(errors: Errors, cell: int, least: Array) -> str:
    """Return a sentence on the best scheme's error, `least`, over the values, and the bound."""
    show = errors.along.show
    if np.isnan(least).any():
        empty = ", ".join(
            show(v) for v, at in zip(errors.values, least, strict=True) if np.isnan(at)
        )
        return f"No scheme has an error at {empty}; leave it out, and the others are compared."

    def tell(n: int) -> str:
        return f"{errors.show(least[n])} ({errors.name_best_scheme(n, cell)})"

    if isinstance(errors.values[0], str):
        return _compare_texts(errors, cell, least)
    first, last = find_ends(errors, least)
    sentence = (
        f"From {show(errors.values[first])} to {show(errors.values[last])} the best scheme's error "
        f"{_name_change(least[first], least[last])} from {tell(first)} to {tell(last)}"
    )
    bound = errors.bound
    if bound is not None:
        sentence += (
            f", and the Kalman bound {_name_change(bound[0], bound[-1])} from {bound[0]:.3g} to "
            f"{errors.show(bound[-1])}"
        )
    sentence += "."
    for what, n, end in (
        ("smallest", int(np.argmin(least)), min(least[0], least[-1])),
        ("largest", int(np.argmax(least)), max(least[0], least[-1])),
    ):
        if differ(least[n], end):
            sentence += f" The error is {what} at {show(errors.values[n])}: {tell(n)}."
    return sentence


def _compare_texts(errors: Errors, cell: int, least: Array) -> str:
    low, high = find_ends(errors, least)
    if not differ(least[low], least[high]):
        return f"The best scheme's error is the same at all values: {errors.show(least[low])}."
    text = " and ".join(
        f"{what} with {errors.along.show(errors.values[n])} ({errors.name_best_scheme(n, cell)}, "
        f"{errors.show(least[n])}"
        + ("" if errors.bound is None else f"; bound {errors.show(errors.bound[n])}")
        + ")"
        for what, n in (("smallest", low), ("largest", high))
    )
    return f"The best scheme's error is {text}."


def differ(one: float, other: float) -> bool:
    """Return whether two errors are called different."""
    return abs(other - one) > LEAST_CHANGE * max(one, other)


def _name_change(first: float, last: float) -> str:
    if not differ(first, last):
        return "hardly changes,"
    return "falls" if last < first else "rises"
