"""Draw the spectrum of a record's displacement, and the spectrum of Ren et al. (2019), Eq. (1)."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.lines import decimate
from owtsweep.motion.modes import LEVEL, Modes
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.describe import tell_fit
from owtsweep.studies.replay.facts import BEYOND, MOST_MODES, summarise_motion
from owtsweep.studies.replay.files import name_file
from owtsweep.studies.replay.place import read_fit

#: The running mean is over 1 / `SHARE` of the periodogram's lines inside the band, but at least
#: over `SMOOTHED` lines. It is drawn if the band has more than 20 * `SMOOTHED` lines.
SMOOTHED, SHARE = 7, 500


def draw(config: ReplayConfig, record: Mapping[str, float]) -> Figure:
    """Draw the periodogram of a record's displacement, its running mean, and a fitted spectrum.

    Raises InputError if the record does not move, or its periodogram has no frequency near the
        band.
    """
    summary = summarise_motion(config, config.grid.files[0])
    if not summary.size["peak"] > 0.0:
        raise InputError("the record does not move, so it has no spectrum")
    frequency, power = summary.frequency, summary.power
    low, high = config.fit_band
    shown = (frequency >= low / 2.0) & (frequency <= BEYOND * high)
    if not np.any(shown):
        raise InputError(
            f"the record's periodogram has no frequency in or near the band [{low:g}, {high:g}] "
            "Hz; use a longer record"
        )
    figure = style.new_figure(9.0, 4.8)
    axes = figure.add_subplot()
    axes.axvspan(low, high, color="0.95", zorder=0)
    drawn = decimate(frequency[shown], power[shown])
    axes.plot(*drawn, color="0.7", linewidth=0.8, label="periodogram")
    lines = int(np.count_nonzero((frequency >= low) & (frequency <= high)))
    if lines > 20 * SMOOTHED:
        count = max(SMOOTHED, lines // SHARE // 2 * 2 + 1)
        mean = np.convolve(power, np.full(count, 1.0 / count), mode="same")
        smooth = decimate(frequency[shown], mean[shown])
        axes.plot(*smooth, color="black", linewidth=1.2, label=f"mean of {count} lines")
    shape = read_fit(record)
    if shape is not None:
        f = np.linspace(low, high, 2000)
        axes.plot(f, shape.density(f), color="#0072B2", linewidth=2.0, label="Eq. (1), fitted")
    top = float(np.max(power[shown]))
    axes.set(yscale="log", ylim=(1e-6 * top, 3.0 * top), xlim=(low / 2.0, BEYOND * high))
    shown_modes = _mark_modes(axes, summary.modes)
    axes.set(xlabel="frequency (Hz)", ylabel="displacement spectrum, x + y (m²/Hz)")
    axes.legend(loc="upper right", frameon=False)
    told = "Eq. (1) could not be fitted inside the band"
    if shape is not None:
        covered = f"{100.0 * record['fit_share']:.0f} % of the variance"
        told = f"{tell_fit(record)}; the fit covers {covered}"
    axes.set_title(f"Spectrum of {name_file(config.grid.files[0])}\n{told}", loc="left")
    share = f"; it holds {100 * record['band_share']:.0f} % of the variance" if shape else ""
    style.footnote(
        figure,
        f"{shown_modes}Horizontal displacement, from {summary.source}. Grey: band "
        f"[{low:g}, {high:g}] Hz, where Eq. (1) is fitted by Whittle likelihood{share}.",
    )
    return figure


def _mark_modes(axes: Axes, modes: Modes) -> str:
    left, right = axes.get_xlim()
    for number, mode in enumerate(modes.found[:MOST_MODES]):
        inside = left <= mode.frequency <= right
        at = min(max(mode.frequency, left), right)
        if inside:
            axes.axvline(at, color="#D55E00", linewidth=1.0, linestyle=(0, (4, 3)), zorder=1)
        arrow = "" if inside else "→ " if mode.frequency > right else "← "
        near_right = at > 0.5 * (left + right)
        axes.annotate(
            f"{arrow}{mode.period:.3g} s, {100.0 * mode.share:.0f} %", (at, 0.04 + 0.07 * number),
            (-4 if near_right else 4, 0), xycoords=("data", "axes fraction"),
            textcoords="offset points", ha="right" if near_right else "left", fontsize=9,
            color="#D55E00",
            bbox={"facecolor": "white", "edgecolor": "none", "alpha": 0.8, "pad": 1.0},
        )  # fmt: skip
    told = f"Dashed: peaks that are more than scatter (p < {LEVEL:g}), with their shares of the "
    return f"{told}variance. " if modes.found else ""
