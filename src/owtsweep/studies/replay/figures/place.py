"""Draw the place of a record in the map of the best scheme by expected mean squared error."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from owtsweep.errors import InputError
from owtsweep.figures import smooth_map
from owtsweep.figures.smooth_map import Field
from owtsweep.results.conditions import Condition
from owtsweep.statistics.contest import agree, group_coinciding
from owtsweep.studies.hub.public import BASELINES, make_field
from owtsweep.studies.replay.advice import LEAST_COVERED, LEAST_MARGIN
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.files import label_files, name_file
from owtsweep.studies.replay.measures import QUANTILE
from owtsweep.studies.replay.place import (
    compute_rms_error,
    compute_rms_in_band,
    expect_map,
    find_place,
    list_left_out,
)

PERIODS, AMPLITUDES = 48, 160
ACROSS = Condition("natural_period", "natural period", "s")
UPWARDS = Condition("amplitude", "amplitude: largest displacement", "m", scale="log")


def draw(config: ReplayConfig, record: Mapping[str, float]) -> Figure:
    """Draw a map of the best scheme by expected settled MSE, and mark the place of a record in it.

    Raises InputError if the record has no place there, or no errors can be computed for a scheme.
    """
    shape, band = find_place(config, record), config.fit_band
    if shape is None:
        raise InputError(
            "no spectrum with a peak inside the band could be fitted to the record, so the "
            "record has no place in the map"
        )
    period, amplitude = 1.0 / shape.peak_frequency, record["peak"]
    ends = (
        QUANTILE * record["natural_period_error"],
        QUANTILE * compute_rms_error(config, record, shape),
    )
    (label,) = label_files(config.grid.files)
    names, baselines, field = _make_field(config, record, (period, amplitude))
    ratio = amplitude / compute_rms_in_band(record)
    left_out = ", ".join(list_left_out(config))
    beside = f" Not in the map: {left_out}." if left_out else ""
    alike = group_coinciding(names, lambda i, j: bool(np.all(agree(*field.values[[i, j]]))))
    figure = smooth_map.draw(
        field,
        names,
        title=f"Place of {name_file(label)} in the map of the best scheme\n"
        f"by expected settled {config.measures.criterion} MSE, tuning: {config.tuning}\n"
        f"{_describe_coverage(record)}",
        origin="Bars of the star: 95 % intervals. That of the period comes from the fit of Eq."
        " (1), that of the amplitude from how far the rms of records of this length scatters in"
        " one sea state. The map: motions of the spectrum translated (bandwidth"
        f" {config.spectrum.bandwidth:g} s⁻²) in"
        f" band [{band[0]:g}, {band[1]:g}] Hz, with this record's ratio of the largest to the"
        f" rms displacement in the band, {ratio:.2f}.{beside}",
        coinciding=alike,
        baselines=baselines,
    )
    _mark(figure.axes[0], (period, amplitude), ends)
    return figure


def _describe_coverage(record: Mapping[str, float]) -> str:
    share = record["fit_share"]
    text = f"the fit of Eq. (1) covers {100.0 * share:.0f} % of this record's variance"
    return text if share >= LEAST_COVERED else f"{text}: no advice for the record"


def _make_field(
    config: ReplayConfig, record: Mapping[str, float], place: tuple[float, float]
) -> tuple[list[str], list[str], Field]:
    (period, amplitude), band, grid = place, config.fit_band, config.grid
    low = max(min([*grid.natural_period, 0.9 * period]), 1.0 / band[1])
    high = min(max([*grid.natural_period, 1.1 * period]), 1.0 / band[0])
    periods = np.linspace(low, high, PERIODS)
    small, large = min([*grid.amplitude, 0.7 * amplitude]), max([*grid.amplitude, 1.5 * amplitude])
    amplitudes = np.geomspace(small, large, AMPLITUDES)
    expected = expect_map(config, record, periods, amplitudes)
    baselines = [name for name in expected if name in BASELINES and name not in config.schemes]
    rivals = np.array([expected.pop(name) for name in baselines])
    values = np.array(list(expected.values()))
    axes, places = (ACROSS, UPWARDS), (periods, amplitudes)
    return list(expected), baselines, make_field(axes, places, values, rivals, LEAST_MARGIN)


def _mark(axes: Axes, place: tuple[float, float], ends: tuple[float, float]) -> None:
    period, amplitude = place
    across = np.full((2, 1), ends[0])
    upwards = [[amplitude - amplitude / np.exp(ends[1])], [amplitude * np.expm1(ends[1])]]
    for width, color in ((4.5, "white"), (1.8, "black")):
        axes.errorbar(
            period, amplitude, xerr=across, yerr=upwards, linestyle="none", ecolor=color,
            elinewidth=width, zorder=6,
        )  # fmt: skip
    axes.plot(
        period, amplitude, marker="*", markersize=14, color="white", markeredgecolor="black",
        markeredgewidth=1.3, zorder=7,
    )  # fmt: skip
    right = period > 0.5 * sum(axes.get_xlim())
    axes.annotate(
        f"this record\n{period:.2f} s, {amplitude:.2g} m", (period, amplitude),
        (-14 if right else 14, 12), ha="right" if right else "left",
        textcoords="offset points", fontsize=9, zorder=7,
        bbox={"boxstyle": "round", "facecolor": "white", "alpha": 0.85, "linewidth": 0},
    )  # fmt: skip
