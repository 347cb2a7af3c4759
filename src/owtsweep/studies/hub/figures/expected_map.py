"""The best scheme as a smooth function of natural period and amplitude, without records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from owtsweep.arrays import Array
from owtsweep.figures import smooth_map, style
from owtsweep.studies.hub.conditions import AMPLITUDE, NATURAL_PERIOD
from owtsweep.studies.hub.expected.answers import RESOLUTION, judge

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: What an amplitude measures, by `normalise`.
MEANING = {"peak": "largest displacement", "rms": "standard deviation"}


def draw(
    values: Array,
    schemes: Sequence[str],
    periods: Array,
    amplitudes: Array,
    *,
    criterion: str,
    window: str,
    tuning: str,
    normalise: str,
    coinciding: Sequence[Sequence[str]] = (),
) -> Figure:
    """Draw the map.

    Parameters
    ----------
    values
        (schemes, periods, amplitudes): expected MSE.
    schemes
        Those compared.
    periods, amplitudes
        Increasing, s and m; both have two values or more.
    """
    verdict = judge(values)
    amplitude = replace(AMPLITUDE, label=f"amplitude: {MEANING[normalise]} along the waves")
    field = smooth_map.Field(
        across=NATURAL_PERIOD,
        upwards=amplitude,
        columns=periods,
        lines=amplitudes,
        values=values,
        best=verdict.best,
        excess=100.0 * (verdict.mse_runner_up / verdict.mse_best - 1.0),
        distinguishable=verdict.distinguishable,
        resolution=RESOLUTION,
    )
    return smooth_map.draw(
        field,
        schemes,
        title=f"Best scheme by expected {criterion} MSE\n"
        f"{style.describe_window(window)}, tuning: {tuning}, no records",
        origin="All values are expectations over all records, computed from error spectra and "
        "noise without any record.",
        coinciding=coinciding,
    )
