"""Say why a run misses a published number, from the parts of the MSE in run and paper.

For a linear scheme, the MSE at the amplitude N is N^2 A + 2 N C + F. A is the mean square error
from motion of unit amplitude, F is the mean square error from sensor noise, and C is the mean
product of both errors. Tables 7 and 8 of Ren et al. (2019) are for one natural period and two
amplitudes. So the tables give the paper's A and F if C is neglected. F depends only on the sensors
and the scheme, so F is equal at all natural periods.
"""

from __future__ import annotations

from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from experiments.ren2019.evidence import Cell, Evidence
from experiments.ren2019.published import published_numbers
from owtsweep.results.superposition import PRODUCTS, superpose
from owtsweep.verdicts.score_table import DIGITS

#: The conditions of tables 7 and 8: one natural period, two amplitudes.
WEAK, STRONG = Cell(8.0, 0.2), Cell(8.0, 1.0)


class Terms(NamedTuple):
    """The three parts of an MSE at the amplitude N, in the unit of the MSE.

    The parts are N^2 A (motion), 2 N C (cross) and F (noise). A is the mean square error from
    motion of unit amplitude, F is the mean square error from noise, and C is the mean product of
    both errors.
    """

    motion: float
    cross: float
    noise: float


@cache
def implied_floor(scheme: str, measure: str) -> float:
    """Compute the part of a scheme's MSE that noise causes, from tables 7 and 8 of the paper.

    The paper is Ren et al. (2019). `measure` is x or y (result in m^2), or vx or vy (result in
    m^2/s^2). The result may be negative, because the product of the errors from motion and noise is
    neglected.
    """
    table = published_numbers()
    chosen = table[(table["scheme"] == scheme) & (table["measure"] == measure)]
    value = chosen.set_index(["natural_period", "amplitude"])["published"]
    return float(_floor(value[WEAK], value[STRONG]))


def _floor(weak: Any, strong: Any) -> Any:
    A = (strong - weak) / (STRONG.amplitude**2 - WEAK.amplitude**2)
    return weak - WEAK.amplitude**2 * A


def _superposed(
    evidence: Evidence, scheme: str, cell: Cell, measure: str, *, both_windows: bool = False
) -> pd.DataFrame:
    """Return the run's rows of one scheme and measure at the natural period of `cell`.

    Only rows that hold motion, cross and noise products are returned; a run has such rows with
    evaluation=superposed. A row is for one of two time windows, the full record or its settled
    part. Only rows of the run's own window are returned, unless `both_windows` is True.
    """
    rows = evidence.finished
    return rows[
        (rows["scheme"] == scheme)
        & (rows["measure"] == measure)
        & (rows["natural_period"].round(DIGITS) == cell.natural_period)
        & rows["amplitude"].isna()
        & (both_windows | (rows["window"] == evidence.window))
    ]


def _mse(rows: pd.DataFrame, cell: Cell) -> Any:
    return superpose(rows["motion"], rows["cross"], rows["noise"], cell.amplitude)


def terms(evidence: Evidence, scheme: str, cell: Cell, measure: str) -> Terms | None:
    """Compute the motion, cross and noise part of a scheme's mean MSE at one point of the grid.

    `cell` is the point: natural period and amplitude. Return None if the run did not compute this
    scheme at this point with evaluation=superposed.
    """
    chosen = _superposed(evidence, scheme, cell, measure)
    if chosen.empty:
        return None
    A, C, F = chosen[list(PRODUCTS)].mean()
    return Terms(float(cell.amplitude**2 * A), float(2.0 * cell.amplitude * C), float(F))


def start_up_share(evidence: Evidence, scheme: str, cell: Cell, measure: str) -> float:
    """Compute which share (0 to 1) of the record's squared error is made before the settling time.

    Returns NaN if there is no error, and unless the run computed this case by superposition
    (evaluation=superposed).
    """
    chosen = _superposed(evidence, scheme, cell, measure, both_windows=True)
    total = (_mse(chosen, cell) * chosen["n_samples"]).groupby(chosen["window"]).sum()
    full = total.get("full", np.nan)
    return float(1.0 - total.get("settled", np.nan) / full) if full > 0.0 else float("nan")


def reason(evidence: Evidence, scheme: str, cell: Cell, measure: str, published: float) -> str:
    """Say in one line why the run's mean MSE misses the number `published`.

    The motion part and the noise part of the run's MSE are replaced by those of Ren et al. (2019),
    one at a time. The cause is the part whose replacement brings the MSE closer to the published
    number. `cell` is the number's natural period and amplitude. If the parts are not known, the
    text says so.
    """
    parts = terms(evidence, scheme, cell, measure)
    if parts is None:
        return "its parts are unknown: evaluation=superposed separates motion from noise"
    total = sum(parts)
    floor = implied_floor(scheme, measure)
    if floor <= 0.0:
        return f"{_shares(parts)}; the print implies no positive noise floor to compare with"
    motion = max(published - floor, 0.0)
    with_noise = _distance(total - parts.noise + floor, published)
    with_motion = _distance(total - parts.motion + motion, published)
    sentences = [_shares(parts), f"its noise floor is {parts.noise / floor:.3g} times the print's"]
    doubt = _doubt(evidence, scheme, measure, floor)
    if doubt:
        sentences.append(doubt)
    if motion > 0.0:
        sentences.append(f"its motion term {parts.motion / motion:.3g} times")
    else:
        sentences.append("the print leaves no room for a motion term")
    cause = "noise floor" if with_noise < with_motion else "motion term"
    with np.errstate(over="ignore"):
        left = np.exp2(min(with_noise, with_motion))
    sentences.append(
        f"mainly the {cause}: with the print's own the number would be within a factor of "
        f"{left:.2f}"
    )
    share = start_up_share(evidence, scheme, cell, measure)
    if np.isfinite(share) and evidence.window == "full":
        sentences.append(f"{_percent(share)} of its squared error is made before the settling time")
    return "; ".join(sentences)


def _distance(value: float, published: float) -> float:
    """Compute |log2(value / published)|; infinite if `value` is not positive."""
    return abs(float(np.log2(value / published))) if value > 0.0 else float("inf")


def _doubt(evidence: Evidence, scheme: str, measure: str, floor: float) -> str:
    """Write a note if the noise part that the paper's tables imply is uncertain; otherwise "".

    The implied noise part, `floor`, neglects the mean product of the errors from motion and noise.
    The noise part of each single record of the run is computed with the same neglect. `floor` is
    uncertain if it lies within the central 95 % of these values.
    """
    rows = _superposed(evidence, scheme, WEAK, measure)
    # F of single records, computed as for the paper, and so with a contribution of C
    floors = _floor(_mse(rows, WEAK), _mse(rows, STRONG))
    if len(floors) < 2:
        return ""
    low, high = np.percentile(floors, [2.5, 97.5])
    if not low <= floor <= high:
        return ""
    return (
        f"but the print's {floor:.1e} is not well known: single records of this run imply "
        f"{low:.1e} to {high:.1e} in the same way"
    )


def _shares(parts: Terms) -> str:
    total = sum(parts)
    if not total > 0.0:
        return f"ours is {total:.3g}"
    motion, cross, noise = (part / total for part in parts)
    product = f", {_percent(cross)} their product" if abs(cross) > 0.005 else ""
    return f"ours is {_percent(motion)} motion, {_percent(noise)} noise{product}"


def _percent(share: float) -> str:
    return f"{100.0 * share:.0f} %"
