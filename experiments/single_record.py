"""Could one record of ours have printed a paper's number? The one rule for "agrees", in all papers.

A paper prints what one record gave. Our mean over many records is nearer to its own truth than any
one of them, so the distance of print and mean says nothing by itself: what counts is how often one
record of ours lies at least as far away. That is a probability, whatever the number, its unit and
its scatter are, so no tolerance has to be chosen for each number.
"""

from __future__ import annotations

from decimal import Decimal
from typing import NamedTuple

import numpy as np

from owtsweep.arrays import Array
from owtsweep.statistics.inference import CONFIDENCE, p_value, t_quantile
from owtsweep.verdicts.inference import UNDECIDED

#: A number agrees if this part of single records, or more, lies at least as far away: the level of
#: all tests here.
LEAST = 1.0 - CONFIDENCE
#: Scatter of records below this part of their mean is rounding: the number is exact.
EXACT = 1e-9


class Print(NamedTuple):
    """A printed number among single records.

    chance: the probability that one record lies at least as far from the mean of the records as the
        print; NaN if the records do not scatter, or are fewer than two.
    low, high: the ends within which one record lies with 95 %; NaN with `chance`.
    """

    chance: float
    low: float
    high: float

    @property
    def agrees(self) -> str:
        """Return "yes", "no", or "undecided" without a chance."""
        return judge(self.chance)


NOWHERE = Print(np.nan, np.nan, np.nan)


def place_print(least: float, greatest: float, samples: Array) -> Print:
    """Return the place of a printed number among the records of a run.

    If records are normal, a further one minus the mean of n is distributed as s sqrt(1 + 1/n) times
    Student's t with n - 1 degrees of freedom, s their standard deviation (Student 1908; Hahn and
    Meeker 1991, Statistical Intervals, chapter 4). Errors are positive and scatter by factors, so
    their logarithms are taken; where a sample or the whole print is not positive, the values
    themselves.

    Parameters
    ----------
    least, greatest
        The print: what rounds to the printed number lies between these (`read_rounded`), or what
        the paper says in words. Distances are those of the nearer end, 0 in between.
    samples
        Values of the run, shape (records,), in the unit of the print.
    """
    n = len(samples)
    if n < 2 or not np.all(np.isfinite(samples)):
        return NOWHERE
    in_factors = bool(np.all(samples > 0.0)) and greatest > 0.0
    ends = np.array([least, greatest])
    if in_factors:
        with np.errstate(divide="ignore"):  # from 0 on: as small as one likes
            ends = np.log(np.maximum(ends, 0.0))
        samples = np.log(samples)
    mean, spread = float(np.mean(samples)), float(np.std(samples, ddof=1))
    if spread <= EXACT * (1.0 if in_factors else abs(mean)):
        return NOWHERE
    width = spread * np.sqrt(1.0 + 1.0 / n)
    distance = max(ends[0] - mean, mean - ends[1], 0.0)
    half = float(t_quantile(n - 1)) * width
    low, high = mean - half, mean + half
    if in_factors:
        low, high = np.exp(low), np.exp(high)
    return Print(float(p_value(distance, width, n - 1)), float(low), float(high))


def read_rounded(text: str) -> tuple[float, float]:
    """Return the ends of what rounds to a printed number: .0755 and .0765 of "7.6e-2"."""
    number = Decimal(text)
    half = Decimal((0, (5,), int(number.as_tuple().exponent) - 1))
    return float(number - half), float(number + half)


def show_chance(chance: float) -> str:
    """Return a probability in few digits, e.g. ".3", "<.001", or a dash if it is NaN."""
    if np.isnan(chance):
        return "–"
    return "<.001" if chance < 1e-3 else f"{chance:.1g}".replace("0.", ".")


def judge(chance: float) -> str:
    """Return whether a number agrees: "yes", "no", or "undecided" if the chance is NaN."""
    if np.isnan(chance):
        return UNDECIDED
    return "yes" if chance >= LEAST else "no"
