"""Draw the place of a record in the map of the best scheme by expected mean squared error."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.studies.replay.advice import LEAST_MARGIN
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.figures.words import name_file
from owtsweep.studies.replay.place import compute_rms_in_band, expect_map, find_place

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PERIODS, AMPLITUDES = 48, 160


def draw(config: ReplayConfig, record: Any) -> Figure:
    """Draw a map of the best scheme by expected settled MSE, and mark the place of a record in it.

    The horizontal axis is the natural period (s), the vertical axis the largest displacement (m).
    `record` is the record's row of records.csv.

    Raises
    ------
    InputError
        If the record has no fitted spectrum with a peak inside the band, or if no errors can be
        computed for one of the schemes.
    """
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    shape, band = find_place(config, record), config.fit_band
    if shape is None:
        raise InputError(
            "no spectrum with a peak inside the band could be fitted to the record, so the "
            "record has no place in the map"
        )
    period, amplitude = 1.0 / shape.peak_frequency, float(record["peak"])
    low = max(min([*config.grid.natural_period, 0.9 * period]), 1.0 / band[1])
    high = min(max([*config.grid.natural_period, 1.1 * period]), 1.0 / band[0])
    periods = np.linspace(low, high, PERIODS)
    small = min([*config.grid.amplitude, 0.7 * amplitude])
    large = max([*config.grid.amplitude, 1.5 * amplitude])
    amplitudes = np.geomspace(small, large, AMPLITUDES)
    expected = expect_map(config, record, periods, amplitudes)
    labels = _label_distinct(expected)
    names = list(labels)
    values = np.array([expected[name] for name in names])
    order = np.sort(values, axis=0)
    best = np.argmin(values, axis=0)
    ratio = float(record["peak"]) / compute_rms_in_band(record)
    with style.context():
        figure = style.new_figure(7.2, 5.6)
        axes = figure.add_subplot()
        colors = ListedColormap([style_of(name, names).color for name in names])
        axes.pcolormesh(
            periods, amplitudes, best.T, cmap=colors, vmin=-0.5, vmax=len(names) - 0.5,
            shading="nearest", rasterized=True,
        )  # fmt: skip
        handles = [
            Patch(facecolor=style_of(names[i], names).color, label=labels[names[i]])
            for i in np.unique(best)
        ]
        if len(names) > 1:
            margin = order[1] / order[0] - 1.0
            axes.contourf(
                periods, amplitudes, margin.T, levels=[0.0, LEAST_MARGIN], colors="none",
                hatches=["////"],
            )  # fmt: skip
            label = f"next best within {100 * LEAST_MARGIN:g} %"
            handles.append(Patch(facecolor="0.8", edgecolor="black", hatch="////", label=label))
        axes.plot(
            period, amplitude, marker="*", markersize=20, color="white", markeredgecolor="black",
            markeredgewidth=1.4,
        )  # fmt: skip
        axes.annotate(
            f"this record\n{period:.2f} s, {amplitude:.2g} m", (period, amplitude),
            (-14, 12) if period > 0.5 * (low + high) else (14, 12),
            ha="right" if period > 0.5 * (low + high) else "left",
            textcoords="offset points", fontsize=9,
            bbox={"boxstyle": "round", "facecolor": "white", "alpha": 0.85, "linewidth": 0},
        )  # fmt: skip
        axes.set_yscale("log")
        axes.grid(visible=False)
        axes.set_xlabel("natural period (s)")
        axes.set_ylabel("amplitude: largest displacement (m)")
        axes.set_title(
            f"Place of {name_file(str(record['file']))} in the map of the best scheme\n"
            f"by expected settled {config.measures.criterion} MSE, tuning: {config.tuning}",
            loc="left",
        )
        figure.legend(handles=handles, loc="outside upper center", ncols=3, frameon=False)
        style.footnote(
            figure,
            f"Motions of the spectrum translated (bandwidth {config.spectrum.bandwidth:g} s⁻²) in "
            f"band [{band[0]:g}, {band[1]:g}] Hz, with this record's ratio of the "
            f"largest to the rms displacement in the band, {ratio:.2f}.",
        )
    return figure


def _label_distinct(expected: Mapping[str, Array]) -> dict[str, str]:
    """Label the schemes for the legend; of schemes with equal errors, only the last gets a label.

    This label names all of these schemes, e.g. "HME1 = HME2". `expected` holds for each scheme its
    expected errors, an array over periods and amplitudes.

    Returns
    -------
    dict
        Scheme -> label.
    """
    labels = {}
    for name, values in expected.items():
        same = [other for other in expected if np.allclose(expected[other], values, rtol=1e-9)]
        if name == same[-1]:
            labels[name] = " = ".join(same)
    return labels
