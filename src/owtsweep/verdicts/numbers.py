"""A published number compared with the single records of a run: a paper shows one record."""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.statistics.student import CONFIDENCE
from owtsweep.verdicts.inference import MISSING, UNDECIDED, mean_ratio

#: The keys of the result of `compare_number`.
COLUMNS = (
    "reproduced", "ci_low", "ci_high", "record_low", "record_high", "quantile", "ratio", "log2",
    "missed_by_factor_2",
)  # fmt: skip
#: Percentiles that bound the central 95 % of single records.
TAILS = (50.0 * (1.0 - CONFIDENCE), 50.0 * (1.0 + CONFIDENCE))


def compare_number(samples: Array | None, published: float) -> dict[str, Any]:
    """A run's result for a published number.

    Parameters
    ----------
    samples
        (records,) values of the run; None if it has none, and then all numbers are NaN.
    published
        Not negative.

    Returns
    -------
    dict
        `COLUMNS`. `reproduced`: mean over the records with its 95 % t interval; `record_low` and
        `record_high`: 2.5th and 97.5th percentile of single records; `quantile`: the part of the
        records below the published number (ties count half); ratio = reproduced / published,
        `log2` its logarithm.
    """
    if samples is None:
        return {**dict.fromkeys(COLUMNS, float("nan")), "missed_by_factor_2": False}
    decision = mean_ratio("", samples, 1.0, published, "above")
    low, high = np.percentile(samples, TAILS)
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
    """Whether the published number could be one of the run's records.

    "yes" inside the central 95 % of single records, "no" outside, "undecided" for a single record,
    "missing" for none.

    Parameters
    ----------
    row
        The result of `compare_number`, and `published`, as attributes.
    """
    if np.isnan(row.reproduced):
        return MISSING
    if row.record_low == row.record_high:
        return UNDECIDED
    return "yes" if row.record_low <= row.published <= row.record_high else "no"
