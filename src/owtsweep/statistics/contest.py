"""Finds the best scheme, those that coincide with it, the next one, and whether that is worse.

All users share these rules: tables of records and of expectations, advice, published statements.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.statistics.student import p_value, t_quantile
from owtsweep.statistics.sums import mean_and_error, ordered_sum

#: Schemes whose values differ by less than this (relative) count as the same estimator.
COINCIDENCE = 1e-9

Flags = NDArray[np.bool_]
Places = NDArray[np.intp]


class Ranking(NamedTuple):
    """The order of the schemes in each cell.

    Attributes
    ----------
    best, runner_up
        (cells,) indices of schemes. Of schemes that coincide, the last is named. The runner-up is
        the best scheme that does not coincide with the winner. Where all coincide it is one of
        them; where only one took part it is -1.
    like_best
        (schemes, cells): whether a scheme coincides with the best; true for the best itself.
    told_apart
        (cells,) whether any other scheme does not coincide with the best.
    """

    best: Places
    runner_up: Places
    like_best: Flags
    told_apart: Flags


class Contest(NamedTuple):
    """The outcome in each cell, (cells,) each; without meaning in cells that are not judged.

    Attributes
    ----------
    judged
        Whether all schemes that took part have finished a common replicate.
    best, runner_up
        As in `Ranking`.
    mse_best, mse_runner_up, difference, ci_low, ci_high
        Means, their paired difference and its 95 % t interval; NaN without a runner-up.
    p
        Two-sided paired t-test of the difference; 1 where nothing can be tested or told apart.
    """

    judged: Flags
    best: Places
    runner_up: Places
    mse_best: Array
    mse_runner_up: Array
    difference: Array
    ci_low: Array
    ci_high: Array
    p: Array


def contest(values: Array) -> Contest:
    """Compare the schemes in every cell over the replicates that all of them finished.

    Parameters
    ----------
    values
        (schemes, cells, replicates), NaN where a case has no value. A scheme without any value in
        a cell takes no part there. Schemes coincide if they agree to `COINCIDENCE` in every
        replicate.
    """
    finite = np.isfinite(values)
    took_part: Flags = np.asarray(finite.any(axis=-1))
    common = np.asarray((finite | ~took_part[..., np.newaxis]).all(axis=0))
    n = common.sum(axis=-1)
    judged = took_part.any(axis=0) & (n > 0)
    with np.errstate(invalid="ignore"):  # cells that are not judged: 0 / 0
        means = ordered_sum(np.where(common & finite, values, 0.0)) / n
    best, place, _, told_apart = rank(means, find_alike(values, took_part, common), took_part)
    second = judged & (place >= 0)
    cells = np.arange(values.shape[1])
    gap = np.where(common & second[:, np.newaxis], values[place, cells], np.nan)
    with np.errstate(invalid="ignore"):
        _, error, _ = mean_and_error(gap - values[best, cells])
    difference = np.where(second, means[place, cells] - means[best, cells], np.nan)
    margin = t_quantile(n - 1) * error
    return Contest(
        judged=judged,
        best=best,
        runner_up=np.where(second, place, -1),
        mse_best=means[best, cells],
        mse_runner_up=np.where(second, means[place, cells], np.nan),
        difference=difference,
        ci_low=difference - margin,
        ci_high=difference + margin,
        p=np.where(second & told_apart, p_value(difference, error, n - 1), 1.0),
    )


def rank(means: Array, alike: Flags, took_part: Flags) -> Ranking:
    """The best scheme of each cell and the next.

    Parameters
    ----------
    means
        (schemes, cells): the values to compare; the least is the best.
    alike
        (schemes, schemes, cells): whether two coincide, from `find_alike`.
    took_part
        (schemes, cells).
    """
    best, like_best = find_least(means, took_part, alike)
    others = took_part & ~like_best
    told_apart = np.asarray(others.any(axis=0))
    rest = took_part & (np.arange(len(means))[:, np.newaxis] != best)
    runner_up, _ = find_least(means, np.where(told_apart, others, rest), alike)
    return Ranking(best, np.where(rest.any(axis=0), runner_up, -1), like_best, told_apart)


def find_least(means: Array, contenders: Flags, alike: Flags) -> tuple[Places, Flags]:
    """Find the contender of least mean (the last of those that coincide), and all that coincide.

    Parameters are those of `rank`; returns (cells,) and (schemes, cells).
    """
    least = np.argmin(np.where(contenders, means, np.inf), axis=0)
    same = alike[least, :, np.arange(means.shape[1])].T & contenders
    last = len(means) - 1 - np.argmax(same[::-1], axis=0)
    return last, same


def find_alike(values: Array, took_part: Flags, common: Flags) -> Flags:
    """Find which schemes coincide in a cell, that is, in every common replicate.

    Parameters
    ----------
    values
        (schemes, cells, replicates).
    took_part
        (schemes, cells).
    common
        (cells, replicates): whether a replicate counts.

    Returns
    -------
    array
        (schemes, schemes, cells), symmetric in the schemes.
    """
    schemes = len(values)
    alike = np.zeros((schemes, *took_part.shape), dtype=bool)
    for i in range(schemes):
        for j in range(i, schemes):
            same = (agree(values[i], values[j]) | ~common).all(axis=-1)
            alike[i, j] = alike[j, i] = same & took_part[i] & took_part[j]
    return alike


def group_coinciding(
    names: Sequence[str], coincide: Callable[[int, int], bool]
) -> list[tuple[str, ...]]:
    """Groups of two or more schemes that coincide, each in the order of `names`.

    `coincide` says whether two schemes coincide, given their indices. A scheme joins the first
    group whose first member coincides with it.
    """
    groups: list[list[int]] = []
    for place in range(len(names)):
        for group in groups:
            if coincide(group[0], place):
                group.append(place)
                break
        else:
            groups.append([place])
    return [tuple(names[place] for place in group) for group in groups if len(group) > 1]


def agree(one: Array, other: Array) -> Flags:
    """Whether two values are equal up to rounding, elementwise."""
    scale = np.maximum(np.abs(one), np.abs(other))
    return np.asarray(np.abs(one - other) <= COINCIDENCE * scale)
