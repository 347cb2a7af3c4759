"""Decides a cell of a map by looks at more and more records: won, tied, or still open.

Look k sees the first 4 2^k records: 8, 16, 32, ... Its level is .05 2 / ((k + 1)(k + 2)). These
levels have the sum .05 without an end, so a larger number of records continues a contest and
changes no decision. At a look every pair of contenders that are left is compared by a one-sided
paired t-test, at the look's level over cells x (contenders - 1), both counted at the start. In each
cell one statement "i is the best" is true; a wrong decision takes a test that rejects it, and there
are contenders - 1 of these. So Bonferroni's bound holds for the whole map and for all looks, and
Holm's steps would gain nothing within a look.

Sources: elimination by paired differences is that of Kim and Nelson (2001), A fully sequential
procedure for indifference-zone selection in simulation, ACM TOMACS 11(3), and of races, Maron and
Moore (1997), The racing algorithm, Artificial Intelligence Review 11; the margin is the
indifference zone of Bechhofer (1954), Ann. Math. Statist. 25(1). Spending a level over looks: Lan
and DeMets (1983), Biometrika 70(3). The transformed t of skewed samples: Hall (1992), On the
removal of skewness by transformation, J. R. Statist. Soc. B 54(1).
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.statistics.contest import agree

#: Probability that a map holds a wrong decision, and the number of records of the first look.
LEVEL, FIRST = 0.05, 8
#: Numbers of records that the looks see.
LOOKS = tuple(FIRST * 2**k for k in range(18))
#: The difference that does not matter, as a share of the error; most records of a cell.
MARGIN, MOST = 0.05, 256
#: From this number of records on, skewed differences are corrected, and a contender may leave that
#: is worse by less than the margin. Before, the t-test of skewed differences errs too often.
ENOUGH = 32
#: Magnitude of the skewness from which on Hall's correction is applied.
SKEWED = 1.0


class Rule(NamedTuple):
    """By what a cell is decided.

    margin: the difference that does not matter, as a share of the error.
    floor: the least such difference, in the error's unit.
    squared: whether the values of records are squares, of whose mean the error is the root;
        otherwise the error is their mean.
    most: Most records of a cell, one of `LOOKS`.
    ties_from: Number of records from which on a tie may be called.
    """

    margin: float = MARGIN
    floor: float = 0.0
    squared: bool = True
    most: int = MOST
    ties_from: int = ENOUGH


class Decision(NamedTuple):
    """What is known of a cell after a look.

    verdict: "won": one contender is left, or all left coincide. "tie": the simplest one left is
        surely at most the margin worse than each other one left. "open": neither, yet. "none": all
        contenders have failed.
    best: Index of the contender to take: the winner, the simplest of a tie, or else the one of
        least mean so far; -1 if all have failed.
    left: indices of the contenders that are left, the simplest first.
    look, records: Number of the last look, from 1, and of the records that it has seen; 0 before
        the first.
    """

    verdict: str
    best: int
    left: tuple[int, ...]
    look: int
    records: int


def find_level(look: int) -> float:
    """Return the level of look number `look`, from 1."""
    return LEVEL * 2.0 / ((look + 1.0) * (look + 2.0))


def decide(values: Array, rule: Rule, cells: int, run: NDArray[np.bool_] | None = None) -> Decision:
    """Return what is known of a cell after the last look that its records allow.

    Before the first look the cell is open, and nobody is best.

    values: shape (contenders, records), the simplest contender first, records in the order in
        which they were made; NaN where a contender failed, or was not run.
    rule: By what the cell is decided.
    cells: Number of cells of the map.
    run: whether a contender was run on a record, same shape; None: all were run on all. There is
        no look at records on which one that is left was not run.
    Raises ValueError if `rule.most` is none of `LOOKS`.
    """
    if rule.most not in LOOKS:
        raise ValueError(f"most: {rule.most} is not the number of records of a look")
    contenders, there = values.shape
    tests = cells * max(contenders - 1, 1)
    found = Decision("open", -1, tuple(range(contenders)), 0, 0)
    for number, records in enumerate(LOOKS, start=1):
        chosen = list(found.left)
        if records > min(there, rule.most) or not (run is None or run[chosen, :records].all()):
            break
        seen = values[chosen, :records]
        level = find_level(number) / tests
        found = take_look(seen, found.left, rule, level)._replace(look=number)
        if found.verdict != "open":
            break
    return found


def take_look(seen: Array, names: tuple[int, ...], rule: Rule, level: float) -> Decision:
    """Compare contenders by all records up to a look; who is surely worse, or has failed, leaves.

    seen, names: Values, shape (contenders, records), and the contenders' indices, the simplest
        first.
    level: the level of each of the look's tests.
    """
    records = seen.shape[1]
    whole = np.isfinite(seen).all(axis=1)
    seen, names = seen[whole], tuple(np.array(names)[whole].tolist())
    if not names:
        return Decision("none", -1, (), 0, records)
    factors = find_growth(seen, rule)
    # [i, j]: is i surely better than j, by more than the margin while there are few records
    allowed = np.ones(len(seen)) if records >= ENOUGH else factors
    better = is_below(seen[:, None] * allowed[:, None, None] - seen[None], level)
    kept = ~better.any(axis=0)
    seen, factors = seen[kept], factors[kept]
    left = tuple(np.array(names)[kept].tolist())
    least = left[int(np.argmin(seen.mean(axis=1)))]
    if agree(seen, seen[0]).all():  # one is left, or all that are left coincide
        return Decision("won", left[0], left, 0, records)
    if records >= rule.ties_from:
        worse = seen[0] - seen[1:] * factors[1:, None]
        if is_below(worse, level).all():
            return Decision("tie", left[0], left, 0, records)
    return Decision("open", least, left, 0, records)


def find_growth(seen: Array, rule: Rule) -> Array:
    """Return by which factor the mean of each contender grows if its error grows by the margin.

    `seen` has the shape (contenders, records), the result (contenders,).
    """
    errors = np.sqrt(seen.mean(axis=1)) if rule.squared else np.abs(seen.mean(axis=1))
    with np.errstate(divide="ignore"):
        share = 1.0 + np.maximum(rule.margin, np.divide(rule.floor, errors))
    share = np.where(errors > 0.0, share, 1.0)
    return np.asarray(share**2 if rule.squared else share)


def is_below(differences: Array, level: float) -> NDArray[np.bool_]:
    """Say whether means are surely below zero, by a one-sided t-test over the last axis.

    With at least `ENOUGH` samples whose skewness exceeds `SKEWED`, the statistic is Hall's (1992),
    T = sqrt(n) (S + g S^2 / 3 + g^2 S^3 / 27 + g / (6 n)), S being mean over standard deviation and
    g the skewness. Equal samples are below zero if they are negative.
    """
    n = differences.shape[-1]
    mean = differences.mean(axis=-1)
    deviation = differences - mean[..., None]
    sigma = np.sqrt(np.mean(deviation**2, axis=-1) * n / (n - 1.0))
    with np.errstate(divide="ignore", invalid="ignore"):
        S = mean / sigma
        T = np.sqrt(n) * S
        if n >= ENOUGH:
            g = np.mean(deviation**3, axis=-1) / sigma**3
            hall = np.sqrt(n) * (S + g * S**2 / 3.0 + g**2 * S**3 / 27.0 + g / (6.0 * n))
            T = np.where(np.abs(g) > SKEWED, hall, T)
    below: NDArray[np.bool_] = np.where(sigma > 0.0, find_quantile(level, n - 1) > T, mean < 0.0)
    return below


@lru_cache(256)
def find_quantile(level: float, freedom: int) -> float:
    """Return the quantile of Student's t at a probability, for some degrees of freedom."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, level))
