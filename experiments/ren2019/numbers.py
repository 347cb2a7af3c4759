"""Compare the 64 numbers of tables 6-9 of Ren et al. (2019) with a run: mean, single records."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from experiments.ren2019.evidence import Cell, Evidence
from experiments.ren2019.published import published_numbers
from experiments.ren2019.reasons import reason
from experiments.single_record import judge, place_print
from owtsweep.arrays import Array
from owtsweep.verdicts.inference import MISSING, mean_ratio

#: The keys of the result of `compare_number`.
COLUMNS = (
    "reproduced", "ci_low", "ci_high", "record_low", "record_high", "chance", "ratio", "log2",
    "missed_by_factor_2",
)  # fmt: skip


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
        95 % t interval. `record_low`, `record_high`: the ends within which one record lies with
        95 %. `chance`: the probability that one record lies at least as far away as the published
        number (`single_record`; its last digit, .1 to 1 %, is neglected). `ratio`: reproduced /
        published. `log2`: base-2 logarithm of `ratio`, minus infinity for the ratio 0
        and NaN for a negative one. `missed_by_factor_2`: whether |log2| > 1. Without samples, this
        is False and all other values are NaN.
    """
    if samples is None:
        return {**dict.fromkeys(COLUMNS, float("nan")), "missed_by_factor_2": False}
    decision = mean_ratio("", samples, 1.0, published, "above")
    place = place_print(published, published, samples)
    with np.errstate(divide="ignore", invalid="ignore"):
        log2 = float(np.log2(decision.value / published))
    found = (
        decision.value, decision.low, decision.high, place.low, place.high, place.chance,
        decision.value / published, log2, abs(log2) > 1.0,
    )  # fmt: skip
    return dict(zip(COLUMNS, found, strict=True))


def lies_within_records(row: Any) -> str:
    """Return whether a published number could come from one record of the run.

    Parameters
    ----------
    row
        An object whose attributes are the keys of `compare_number`'s result.

    Returns
    -------
    str
        As `single_record.judge`; "missing" if the run has no values.
    """
    return MISSING if np.isnan(row.reproduced) else judge(row.chance)


def compare_numbers(evidence: Evidence) -> pd.DataFrame:
    """Compare the 64 numbers of tables 6-9 of Ren et al. (2019) with the numbers of a run.

    Returns
    -------
    DataFrame
        One row per published number, in the order of the paper. Columns table, natural_period (s),
        amplitude (m), scheme, measure, published, printed, the keys of
        `compare_number`, why. The numbers are MSEs, of x and y in m^2, of vx and
        vy in m^2/s^2. `why` says where the published number lies among the run's records. `why`
        also gives the cause if the run misses the number by more than a factor of 2. If the run
        lacks the condition or the scheme, the run's values are NaN and `why` says "not in this
        run". `published` is `printed`, but for
        EKF's v_x in Table 7: it is judged at 1.98e-3, not at the printed 1.98e-2, which must be a
        misprint.
    """
    rows = [_row(evidence, printed) for printed in published_numbers().to_dict("records")]
    return pd.DataFrame(rows).drop(columns="note")


def _row(evidence: Evidence, printed: dict[Any, Any]) -> dict[Any, Any]:
    cell = Cell(printed["natural_period"], printed["amplitude"])
    scheme, measure, published = printed["scheme"], printed["measure"], printed["published"]
    samples = evidence.samples(scheme, cell, measure)
    compared = compare_number(samples, published)
    notes = [f"judged at {published:.2e}: {printed['note']}"] if printed["note"] else []
    if samples is None:
        notes.append("not in this run")
    else:
        place = (
            f"one record lies as far away as the print with probability {compared['chance']:.2g}, "
            f"and with 95 % in {compared['record_low']:.2e} to {compared['record_high']:.2e}"
        )
        notes.insert(0, place)
    if compared["missed_by_factor_2"]:
        notes.append(reason(evidence, scheme, cell, measure, published))
    return {**printed, **compared, "why": "; ".join(notes)}
