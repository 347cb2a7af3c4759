"""Draws a displacement record and its spectrum, like figures 3 and 4 of Ren et al. (2019).

The paper's record was simulated by HAWC2. The record drawn here is one of the study, made from the
spectrum of the paper's Eq. (1).
"""

from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.figure import Figure
from scipy.signal import welch

from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.figures.lines import decimate
from owtsweep.motion.spectra import spectrum
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.figures import MEANING
from owtsweep.studies.hub.histories import natural_period_of
from owtsweep.studies.hub.records import make_records

#: Segment length of Welch's estimate, s: long enough to resolve the peak of Eq. (1), whose
#: half-bandwidth is 1/64 Hz.
SEGMENT = 200.0
#: Length of the detail shown below the whole record, s.
DETAIL = 60.0
AXES = ("x (north)", "y (east)")
MEASURED, GIVEN, EDGE = "#0072B2", "#D55E00", "0.45"


def draw_record(config: HubConfig) -> Figure:
    """Draw x and y of the study's first displacement record; a detail shows one minute."""
    period, step, series = _first_record(config)
    time = step * np.arange(len(series))
    start = 0.5 * max(time[-1] - DETAIL, 0.0)
    detail = (time >= start) & (time <= start + DETAIL)

    figure = style.new_figure(10.0, 5.6)
    panels = figure.subplots(2, 2, sharey=True, width_ratios=[2, 1])
    for line, name, values in zip(panels, AXES, series.T, strict=True):
        for axes, chosen in zip(line, (np.full(len(time), True), detail), strict=True):
            t, shown = decimate(time[chosen], values[chosen])
            axes.plot(t, shown, color=MEASURED, linewidth=0.5 if chosen.all() else 1.1)
            axes.set_xlim(t[0], t[-1])
        line[0].set_ylabel(f"{name} (m)")
    for axes, title in zip(panels[0], ("the record", f"{DETAIL:g} s of it"), strict=True):
        axes.set_title(title, loc="left")
    for axes in panels[1]:
        axes.set_xlabel("time (s)")
    title = f"Hub displacement, natural period {period:g} s"
    figure.suptitle(title, x=0.01, ha="left", fontsize=12)
    style.footnote(
        figure,
        f"Record 0 of the study: random phases, spectrum of Eq. (1), waves towards "
        f"{config.wave_direction:g}° east of north, {_scale(config)}."
        " The paper's Figure 3 shows a HAWC2 simulation, which is not published.",
    )
    return figure


def draw_spectrum(config: HubConfig) -> Figure:
    """Draw the spectrum of the study's first displacement record, in a panel for x and one for y.

    Each panel also shows the spectrum of Eq. (1) of Ren et al. (2019), scaled to the record's
    variance.
    """
    period, step, series = _first_record(config)
    rate = 1.0 / step
    length = min(round(SEGMENT * rate), len(series))
    frequency, density = welch(series, fs=rate, nperseg=length, axis=0)
    shape = spectrum(config.spectrum.kind, period, config.spectrum.bandwidth)
    low, high = config.band
    fine = np.linspace(low, high, 4000)
    given = shape.density(fine)
    given /= np.trapezoid(given, fine)
    shown = (frequency > 0.0) & (frequency <= 1.25 * high)
    measured: dict[str, Any] = {
        "color": MEASURED, "marker": ".", "markersize": 3, "linewidth": 0.9,
        "label": "this record (Welch)",
    }  # fmt: skip

    figure = style.new_figure(10.0, 4.8)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, name, values, estimate in zip(panels, AXES, series.T, density.T, strict=True):
        axes.semilogy(frequency[shown], estimate[shown], **measured)
        scaled = np.var(values) * given
        axes.semilogy(fine, scaled, color=GIVEN, linewidth=1.6, label="S(f), Eq. (1), scaled")
        axes.axvline(low, color=EDGE, linestyle="--", label="edges of the band")
        axes.axvline(high, color=EDGE, linestyle="--")
        axes.set_ylim(0.1 * scaled.min(), 4.0 * scaled.max())
        axes.set_title(name, loc="left")
        axes.set_xlabel("frequency (Hz)")
    panels[0].set_xlim(0.0, 1.25 * high)
    panels[0].set_ylabel("displacement spectrum (m²/Hz)")
    panels[1].legend(loc="upper right", framealpha=1.0, edgecolor="none")
    title = f"Displacement spectrum, natural period {period:g} s (1/T = {1 / period:.3f} Hz)"
    figure.suptitle(title, x=0.01, ha="left", fontsize=12)
    segments = 2 * (len(series) // length) - 1
    style.footnote(
        figure,
        f"Record 0, {_scale(config)}. Welch's estimate from {segments}"
        f" Hann segments of {length / rate:g} s, half overlapping, one standard deviation about"
        f" ±{100.0 * np.sqrt(1.2 / segments):.0f} %; what it shows outside the band leaks from"
        " inside. S(f) is scaled to the record's variance; nothing is fitted.",
    )
    return figure


def _first_record(config: HubConfig) -> tuple[float, float, Array]:
    """Return natural period (s), time step (s) and displacement (m) of the study's first record.

    The displacement has the shape (steps, 2), columns x and y.
    """
    period = natural_period_of(config)
    records = make_records(config, period, [0])
    return period, records.sensors.step, np.outer(records.motion[0].position, records.direction)


def _scale(config: HubConfig) -> str:
    return f"{MEANING[config.normalise]} 1 m along the waves"
