"""Compare published numbers with a run: with its mean over the records and with single records.

Single records matter because a paper shows the result of one record.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.statistics.inference import CONFIDENCE
from owtsweep.verdicts.inference import MISSING, UNDECIDED, mean_ratio

#: The keys of the result of `compare_number`.
COLUMNS = (
    "reproduced", "ci_low", "ci_high", "record_low", "record_high", "quantile", "ratio", "log2",
    "missed_by_factor_2",
)  # fmt: skip
#: Percentiles that bound the central 95 % of single records.
TAILS = (50.0 * (1.0 - CONFIDENCE), 50.0 * (1.0 + CONFIDENCE))


def compare_number(samples: Array | None, published: float) -> dict[str, Any]:
    """Compare a run's values with a published number.

    Parameters
    ----------
    samples
        Values of the run, shape (records,); None if the run has none.
    published
        The published number, positive.

    Returns
    -------
    dict
        The keys are `COLUMNS`. `reproduced`, `ci_low`, `ci_high`: mean over the records with its
        95 % t interval. `record_low`, `record_high`: 2.5th and 97.5th percentile of single records.
        `quantile`: the fraction of records below the published number (ties count half). `ratio`:
        reproduced / published. `log2`: base-2 logarithm of `ratio`, minus infinity for the ratio 0
        and NaN for a negative one. `missed_by_factor_2`: whether |log2| > 1. Without samples, this
        is False and all other values are NaN.
    """
    if samples is None:
        return {**dict.fromkeys(COLUMNS, float("nan")), "missed_by_factor_2": False}
    decision = mean_ratio("", samples, 1.0, published, "above")
    low, high = np.percentile(samples, TAILS)
    with np.errstate(divide="ignore", invalid="ignore"):
        log2 = float(np.log2(decision.value / published))
    return {
        "reproduced": decision.value,
        "ci_low": decision.low,
        "ci_high": decision.high,
        "record_low": float(low),
        "record_high": float(high),
        "quantile": float(np.mean(samples < published) + 0.5 * np.mean(samples == published)),
        "ratio": decision.value / published,
        "log2": log2,
        "missed_by_factor_2": abs(log2) > 1.0,
    }


def lies_within_records(row: Any) -> str:
    """Return whether a published number could come from one of the run's records.

    Parameters
    ----------
    row
        An object whose attributes are `published` and the keys of `compare_number`'s result.

    Returns
    -------
    str
        "yes" if the published number lies within the central 95 % of the records' values, "no" if
        it lies outside, "undecided" if these 95 % are a single value (e.g. with one record),
        "missing" if the run has no values.
    """
    if np.isnan(row.reproduced):
        return MISSING
    if row.record_low == row.record_high:
        return UNDECIDED
    return "yes" if row.record_low <= row.published <= row.record_high else "no"
