"""Finds the best scheme in each cell, and whether the next best scheme is significantly worse.

`challenge` then compares the best scheme with baselines, which do not compete for the first place.
Two schemes coincide if their values are equal up to rounding. These rules hold for tables of
results, for advice, and for checks of the paper's claims.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.statistics.inference import mean_and_error, ordered_sum, p_value, t_quantile

#: Schemes coincide if the relative difference of their values is at most this.
COINCIDENCE = 1e-9

Flags = NDArray[np.bool_]
Places = NDArray[np.intp]


class Ranking(NamedTuple):
    """The best scheme and the runner-up in each cell.

    best, runner_up: indices of schemes, shape (cells,). Of schemes that coincide, the last one
        stands for all. The runner-up is the best scheme that does not coincide with the best
        scheme. If all schemes of a cell coincide, the runner-up is one of them; if only one took
        part, it is -1.
    like_best: whether a scheme is the best or coincides with it, shape (schemes, cells).
    told_apart: whether some scheme does not coincide with the best scheme, shape (cells,).
    """

    best: Places
    runner_up: Places
    like_best: Flags
    told_apart: Flags


class Contest(NamedTuple):
    """The comparison of the schemes in each cell; all attributes have the shape (cells,).

    judged: whether there is a replicate that all schemes taking part in the cell have finished. If
        not, the other attributes have no meaning.
    n: Number of these replicates.
    best, runner_up: indices of the scheme of least mean and of the runner-up (see `Ranking`).
    mse_best, mse_runner_up: Means of both; the latter is NaN without a runner-up.
    mse_low, mse_high: Ends of the 95 % confidence interval of `mse_best`; NaN for one replicate.
    difference, ci_low, ci_high: `mse_runner_up` minus `mse_best`, and its 95 % confidence interval
        by the paired t-test; NaN without a runner-up.
    p: Two-sided p-value of that test; 1 if there are too few replicates for a test, or all schemes
        of the cell coincide.
    """

    judged: Flags
    n: Places
    best: Places
    runner_up: Places
    mse_best: Array
    mse_runner_up: Array
    mse_low: Array
    mse_high: Array
    difference: Array
    ci_low: Array
    ci_high: Array
    p: Array


class Challenge(NamedTuple):
    """The comparison of each cell's best scheme with the best of some baselines, (cells,) each.

    In cells in which no replicate counts, the fields have no meaning.

    `baseline`, `mse_baseline`: index of the baseline of least mean, and this mean; -1 and NaN if no
    baseline has all values that count. `gain`: by how much this mean is less than the best
    scheme's; NaN if there is none. `p_baseline`: two-sided p-value of the paired t-test of `gain`;
    1 if there are too few replicates.
    """

    baseline: Places
    mse_baseline: Array
    gain: Array
    p_baseline: Array


def contest(values: Array) -> Contest:
    """Compare the schemes in every cell over the replicates that all of them finished.

    `values` has the shape (schemes, cells, replicates); NaN where a scheme did not finish a
    replicate. The scheme of least mean is the best. A scheme without any value in a cell takes no
    part in it. Two schemes coincide in a cell if their values agree to `COINCIDENCE` in every
    replicate that is compared.
    """
    took_part, common = find_common(values)
    n = common.sum(axis=-1)
    judged = took_part.any(axis=0) & (n > 0)
    means = _average(values, common)
    best, place, _, told_apart = rank(means, find_alike(values, took_part, common), took_part)
    second = judged & (place >= 0)
    cells = np.arange(values.shape[1])
    gap = np.where(common & second[:, np.newaxis], values[place, cells], np.nan)
    with np.errstate(invalid="ignore"):
        _, error, _ = mean_and_error(gap - values[best, cells])
        _, own_error, _ = mean_and_error(np.where(common, values[best, cells], np.nan))
    difference = np.where(second, means[place, cells] - means[best, cells], np.nan)
    quantile = t_quantile(n - 1)
    margin, half = quantile * error, quantile * own_error
    return Contest(
        judged=judged,
        n=n,
        best=best,
        runner_up=np.where(second, place, -1),
        mse_best=means[best, cells],
        mse_runner_up=np.where(second, means[place, cells], np.nan),
        mse_low=means[best, cells] - half,
        mse_high=means[best, cells] + half,
        difference=difference,
        ci_low=difference - margin,
        ci_high=difference + margin,
        p=np.where(second & told_apart, p_value(difference, error, n - 1), 1.0),
    )


def challenge(values: Array, best: Places, baselines: Array) -> Challenge:
    """Compare the best scheme of every cell with the best baseline, over the replicates that count.

    values, best: the values of the schemes, as for `contest`, and the best scheme that it found.
        The replicates that count are those that all schemes of the cell finished.
    baselines: the values of the baselines, shape (baselines, cells, replicates). A baseline takes
        part in a cell if it has a value in every replicate that counts.
    """
    _, common = find_common(values)
    cells = np.arange(values.shape[1])
    able: Flags = np.asarray((np.isfinite(baselines) | ~common).all(axis=-1))
    means = np.where(able, _average(baselines, common), np.inf)
    least = np.argmin(means, axis=0)
    there: Flags = np.asarray(able.any(axis=0))
    gap = np.where(common & there[:, np.newaxis], values[best, cells], np.nan)
    with np.errstate(invalid="ignore"):
        _, error, n = mean_and_error(gap - baselines[least, cells])
    mse_baseline = np.where(there, means[least, cells], np.nan)
    gain = _average(values[best, cells], common) - mse_baseline
    return Challenge(np.where(there, least, -1), mse_baseline, gain, p_value(gain, error, n - 1))


def find_common(values: Array) -> tuple[Flags, Flags]:
    """Find which schemes take part in a cell, and which replicates count there.

    That is whether a scheme has any value in a cell, shape (schemes, cells), and whether all such
    schemes have a value in a replicate, shape (cells, replicates). `values` are as for `contest`.
    """
    finite = np.isfinite(values)
    took_part: Flags = np.asarray(finite.any(axis=-1))
    return took_part, np.asarray((finite | ~took_part[..., np.newaxis]).all(axis=0))


def _average(values: Array, common: Flags) -> Array:
    """Return the means over the replicates that count; NaN in cells in which none does."""
    with np.errstate(invalid="ignore"):  # 0 / 0
        total = ordered_sum(np.where(common & np.isfinite(values), values, 0.0))
        return np.asarray(total / common.sum(axis=-1))


def rank(means: Array, alike: Flags, took_part: Flags) -> Ranking:
    """Find the best scheme and the runner-up in each cell.

    `means`: the values to compare, shape (schemes, cells); the least is the best. `alike`: whether
    two schemes coincide, shape (schemes, schemes, cells). `took_part`: whether a scheme takes part
    in a cell, shape (schemes, cells).
    """
    best, like_best = find_least(means, took_part, alike)
    others = took_part & ~like_best
    told_apart = np.asarray(others.any(axis=0))
    rest = took_part & (np.arange(len(means))[:, np.newaxis] != best)
    runner_up, _ = find_least(means, np.where(told_apart, others, rest), alike)
    return Ranking(best, np.where(rest.any(axis=0), runner_up, -1), like_best, told_apart)


def find_least(means: Array, contenders: Flags, alike: Flags) -> tuple[Places, Flags]:
    """Find the contender of least mean in each cell, and all contenders that coincide with it.

    Arguments are as for `rank`. Return the index of the best contender, shape (cells,), the last of
    those that coincide; and whether a scheme is one of those, shape (schemes, cells).
    """
    least = np.argmin(np.where(contenders, means, np.inf), axis=0)
    same = alike[least, :, np.arange(means.shape[1])].T & contenders
    last = len(means) - 1 - np.argmax(same[::-1], axis=0)
    return last, same


def find_alike(values: Array, took_part: Flags, common: Flags) -> Flags:
    """Find which schemes coincide in a cell: their values agree in every replicate that counts.

    `values` are as for `contest`, the others as `find_common` returns them. The result, shape
    (schemes, schemes, cells), is symmetric, and false if one of the two takes no part in the cell.
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
    """Group schemes that coincide; return the groups of two or more, each in the order of `names`.

    `coincide` compares two indices in `names`. A scheme joins the first group whose first member it
    coincides with.
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
    """Return, elementwise, whether two arrays agree to `COINCIDENCE`; NaN agrees with nothing."""
    scale = np.maximum(np.abs(one), np.abs(other))
    return np.asarray(np.abs(one - other) <= COINCIDENCE * scale)
