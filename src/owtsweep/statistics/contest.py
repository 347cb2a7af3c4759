"""Which scheme is best in each of many cells, and whether the records tell it from the next."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.cube import mean_and_error, ordered_sum, p_values, t_quantile

#: Schemes whose values differ by less than this, relative, count as the same estimator.
COINCIDENCE = 1e-9

Flags = NDArray[np.bool_]
Places = NDArray[np.intp]


class Contest(NamedTuple):
    """The outcome in each cell, (cells,) each; only cells with a common replicate are meant.

    Attributes
    ----------
    judged
        Whether there is a replicate that all schemes which took part have finished.
    best, runner_up
        Places among the schemes; the runner-up is -1 where only one took part.
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

    Schemes that agree to `COINCIDENCE` in every replicate count as one, under the last of their
    places; the runner-up is the best of those that do not coincide with the best.

    Parameters
    ----------
    values
        (schemes, cells, replicates), NaN where a case has no value. A scheme without any value in
        a cell takes no part there.
    """
    finite = np.isfinite(values)
    took_part: Flags = np.asarray(finite.any(axis=-1))
    common = (finite | ~took_part[..., np.newaxis]).all(axis=0)
    n = common.sum(axis=-1)
    judged = took_part.any(axis=0) & (n > 0)
    with np.errstate(invalid="ignore"):  # cells that are not judged: 0 / 0
        means = ordered_sum(np.where(common & finite, values, 0.0)) / n
    alike = _alike(values, np.asarray(common), took_part)

    best, like_best = _least(means, took_part, alike)
    others = took_part & ~like_best
    told_apart = others.any(axis=0)
    cells = np.arange(values.shape[1])
    rest = took_part & (np.arange(len(values))[:, np.newaxis] != best)
    runner_up, _ = _least(means, np.where(told_apart, others, rest), alike)
    second = judged & rest.any(axis=0)

    gap = np.where(common & second[:, np.newaxis], values[runner_up, cells], np.nan)
    with np.errstate(invalid="ignore"):
        _, error, _ = mean_and_error(gap - values[best, cells])
    difference = np.where(second, means[runner_up, cells] - means[best, cells], np.nan)
    margin = t_quantile(n - 1) * error
    return Contest(
        judged=judged,
        best=best,
        runner_up=np.where(second, runner_up, -1),
        mse_best=means[best, cells],
        mse_runner_up=np.where(second, means[runner_up, cells], np.nan),
        difference=difference,
        ci_low=difference - margin,
        ci_high=difference + margin,
        p=np.where(second & told_apart, p_values(difference, error, n), 1.0),
    )


def agree(one: Array, other: Array) -> Flags:
    """Where two values are the same up to rounding."""
    scale = np.maximum(np.abs(one), np.abs(other))
    return np.asarray(np.abs(one - other) <= COINCIDENCE * scale)


def _alike(values: Array, common: Flags, took_part: Flags) -> Flags:
    """Whether two schemes coincide in a cell, (schemes, schemes, cells)."""
    schemes = len(values)
    alike = np.zeros((schemes, *took_part.shape), dtype=bool)
    for i in range(schemes):
        for j in range(i, schemes):
            same = (agree(values[i], values[j]) | ~common).all(axis=-1)
            alike[i, j] = alike[j, i] = same & took_part[i] & took_part[j]
    return alike


def _least(means: Array, contenders: Flags, alike: Flags) -> tuple[Places, Flags]:
    """The contender of least mean, by the last of those it coincides with, and all those."""
    least = np.argmin(np.where(contenders, means, np.inf), axis=0)
    same = alike[least, :, np.arange(means.shape[1])].T & contenders
    last = len(means) - 1 - np.argmax(same[::-1], axis=0)
    return last, same
