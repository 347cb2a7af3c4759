"""The 64 numbers of tables 6-9 beside what a run gives for them."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.statistics.student import CONFIDENCE
from owtsweep.studies.hub.fidelity.evidence import Cell, Evidence
from owtsweep.studies.hub.fidelity.reasons import reason
from owtsweep.studies.hub.fidelity.score import published_numbers
from owtsweep.verdicts.inference import MISSING, UNDECIDED, mean_ratio

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    "table", "natural_period", "amplitude", "scheme", "measure", "published", "reproduced",
    "ci_low", "ci_high", "record_low", "record_high", "quantile", "ratio", "log2",
    "missed_by_factor_2", "why",
)  # fmt: skip
NOT_IN_RUN = "not in this run"
#: The central part of single records: the paper has one record.
TAILS = (50.0 * (1.0 - CONFIDENCE), 50.0 * (1.0 + CONFIDENCE))
#: A factor of 2, as a log2.
MISSED = 1.0


def compare_numbers(evidence: Evidence) -> pd.DataFrame:
    """Published and reproduced numbers, one a row, in the order of the print.

    Returns
    -------
    DataFrame
        `COLUMNS`. `reproduced`: mean over the records with its 95 % t interval; `record_low` and
        `record_high`: 2.5th and 97.5th percentile of single records; `quantile`: the part of the
        records that lies below the published number (ties count half); ratio = reproduced /
        published, `log2` its logarithm. `why` says where the print lies among the records, and for
        a number missed by more than a factor of 2 what makes the difference. MSE of x and y in
        m^2, of vx and vy in m^2/s^2. Table 7's v_x of EKF is judged at 1.98e-3, not at the print's
        1.98e-2. A number whose condition or scheme the run lacks is NaN, "not in this run".
    """
    import pandas as pd

    rows = [_row(evidence, printed) for printed in published_numbers().to_dict("records")]
    return pd.DataFrame(rows, columns=list(COLUMNS))


def _row(evidence: Evidence, printed: dict[Any, Any]) -> dict[str, Any]:
    cell = Cell(printed["natural_period"], printed["amplitude"])
    scheme, measure, published = printed["scheme"], printed["measure"], printed["published"]
    keys = ("table", "natural_period", "amplitude", "scheme", "measure", "published")
    row = {key: printed[key] for key in keys}
    notes = [f"judged at {published:.2e}: {printed['note']}"] if printed["note"] else []
    samples = evidence.samples(scheme, cell, measure)
    if samples is None:
        nothing = dict.fromkeys(COLUMNS[len(keys) : -2], float("nan"))
        notes.append(NOT_IN_RUN)
        return {**row, **nothing, "missed_by_factor_2": False, "why": "; ".join(notes)}
    against = mean_ratio("", samples, 1.0, published, "above")
    low, high = np.percentile(samples, TAILS)
    log2 = float(np.log2(against.value / published))
    missed = abs(log2) > MISSED
    notes.insert(0, _place(samples, published, float(low), float(high)))
    if missed:
        notes.append(reason(evidence, scheme, cell, measure, published))
    return {
        **row,
        "reproduced": against.value,
        "ci_low": against.low,
        "ci_high": against.high,
        "record_low": float(low),
        "record_high": float(high),
        "quantile": quantile_of(published, samples),
        "ratio": against.value / published,
        "log2": log2,
        "missed_by_factor_2": missed,
        "why": "; ".join(notes),
    }


def quantile_of(value: float, samples: Array) -> float:
    """The part of the samples below a value, ties counting half."""
    return float(np.mean(samples < value) + 0.5 * np.mean(samples == value))


def lies_within_records(row: Any) -> str:
    """Whether the published number could be one of the run's records: yes, no or undecided.

    "yes" inside the central 95 % of single records, "no" outside, "undecided" for a single record,
    "missing" for none.
    """
    if np.isnan(row.reproduced):
        return MISSING
    if row.record_low == row.record_high:
        return UNDECIDED
    return "yes" if row.record_low <= row.published <= row.record_high else "no"


def _place(samples: Array, published: float, low: float, high: float) -> str:
    quantile = quantile_of(published, samples)
    return (
        f"the print lies at quantile {quantile:.2f} of {len(samples)} records, "
        f"95 % of which lie in {low:.2e} to {high:.2e}"
    )
