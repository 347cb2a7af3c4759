"""Draws a displacement record and its spectrum, like figures 3 and 4 of Ren et al. (2019).

The paper's record was simulated by HAWC2. The record drawn here is one of the study: made from the
spectrum of the paper's Eq. (1), or with motion=plant by the structure in the sea of these figures.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.figure import Figure
from scipy.signal import welch

from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.figures.lines import decimate
from owtsweep.motion.source import Spectrum, translated
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import MEANING
from owtsweep.studies.hub.histories import make_record
from owtsweep.studies.hub.worlds import PLANT

#: Segment length of Welch's estimate, s: long enough to resolve the peak of Eq. (1), whose
#: half-bandwidth is 1/64 Hz.
SEGMENT = 200.0
#: Length of the detail shown below the whole record, s.
DETAIL = 60.0
#: Sea state of the paper's figures 3 and 4.
SEA = {"hs": 2.0, "tp": 8.0}
AXES = ("x (north)", "y (east)")
MEASURED, GIVEN, EDGE = "#0072B2", "#D55E00", "0.45"


@dataclass(frozen=True)
class Displacement:
    """The displacement of the hub in record 0, and what the figures say about the record.

    series, step: displacement in m, shape (steps, 2), columns x and y; and the time step, s.
    natural_period: s; that of the first mode with motion=plant.
    title, made_of, size: the motion for titles; of what the record is made, and how large the
        motion is.
    given, given_label: the spectrum of Eq. (1) of Ren et al. (2019) at this period, and its label.
    peaks: label -> frequency (Hz) at which a peak of the spectrum is expected.
    """

    series: Array
    step: float
    natural_period: float
    title: str
    made_of: str
    size: str
    given: Spectrum
    given_label: str
    peaks: dict[str, float]


def draw_record(config: HubConfig) -> Figure:
    """Draw x and y of the study's first displacement record; a detail shows one minute."""
    record = _first_record(config)
    time = record.step * np.arange(len(record.series))
    start = 0.5 * max(time[-1] - DETAIL, 0.0)
    detail = (time >= start) & (time <= start + DETAIL)

    figure = style.new_figure(10.0, 5.6)
    panels = figure.subplots(2, 2, sharey=True, width_ratios=[2, 1])
    for line, name, values in zip(panels, AXES, record.series.T, strict=True):
        for axes, chosen in zip(line, (np.full(len(time), True), detail), strict=True):
            t, shown = decimate(time[chosen], values[chosen])
            axes.plot(t, shown, color=MEASURED, linewidth=0.5 if chosen.all() else 1.1)
            axes.set_xlim(t[0], t[-1])
        line[0].set_ylabel(f"{name} (m)")
    for axes, title in zip(panels[0], ("the record", f"{DETAIL:g} s of it"), strict=True):
        axes.set_title(title, loc="left")
    for axes in panels[1]:
        axes.set_xlabel("time (s)")
    figure.suptitle(f"Hub displacement, {record.title}", x=0.01, ha="left", fontsize=12)
    style.footnote(
        figure,
        f"Record 0 of the study: random phases, {record.made_of}, waves towards "
        f"{config.wave_direction:g}° east of north, {record.size}."
        " The paper's Figure 3 shows a HAWC2 simulation, which is not published.",
    )
    return figure


def draw_spectrum(config: HubConfig) -> Figure:
    """Draw the spectra of x and y in the study's first record, and that of the paper's Eq. (1)."""
    record = _first_record(config)
    rate, series = 1.0 / record.step, record.series
    length = min(round(SEGMENT * rate), len(series))
    frequency, density = welch(series, fs=rate, nperseg=length, axis=0)
    low, high = config.band
    fine = np.linspace(low, high, 4000)
    given = record.given.density(fine)
    given /= np.trapezoid(given, fine)
    shown = (frequency > 0.0) & (frequency <= 1.25 * high)
    measured: style.Look = {
        "color": MEASURED, "marker": ".", "markersize": 3, "linewidth": 0.9,
        "label": "this record (Welch)",
    }  # fmt: skip

    figure = style.new_figure(10.0, 4.8)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, name, values, estimate in zip(panels, AXES, series.T, density.T, strict=True):
        axes.semilogy(frequency[shown], estimate[shown], **measured)
        scaled = np.var(values) * given
        axes.semilogy(fine, scaled, color=GIVEN, linewidth=1.6, label=record.given_label)
        highest = scaled.max()
        if record.peaks:
            for (label, peak), linestyle in zip(record.peaks.items(), ("--", ":"), strict=True):
                axes.axvline(peak, color=EDGE, linestyle=linestyle, zorder=1.0, label=label)
            highest = max(highest, estimate.max())
        else:
            axes.axvline(low, color=EDGE, linestyle="--", label="edges of the band")
            axes.axvline(high, color=EDGE, linestyle="--")
        axes.set_ylim(0.1 * scaled.min(), 4.0 * highest)
        axes.set_title(name, loc="left")
        axes.set_xlabel("frequency (Hz)")
    panels[0].set_xlim(0.0, 1.25 * high)
    panels[0].set_ylabel("displacement spectrum (m²/Hz)")
    panels[1].legend(loc="upper right", framealpha=1.0, edgecolor="none")
    own = f"1/T = {1 / record.natural_period:.3f} Hz"
    title = f"Displacement spectrum, {record.title} ({own})"
    figure.suptitle(title, x=0.01, ha="left", fontsize=12)
    segments = 2 * (len(series) // length) - 1
    outside = "" if record.peaks else "; what it shows outside the band leaks from inside"
    style.footnote(
        figure,
        f"Record 0, {record.size}. Welch's estimate from {segments}"
        f" Hann segments of {length / rate:g} s, half overlapping, one standard deviation about"
        f" ±{100.0 * np.sqrt(1.2 / segments):.0f} %{outside}. S(f) is scaled to the record's "
        "variance; nothing is fitted.",
    )
    return figure


def _first_record(config: HubConfig) -> Displacement:
    """Make record 0; with motion=plant that of the sea state nearest to `SEA`."""
    records, period, _, conditions = make_record(config, SEA)
    position = records.motion[0].position
    make = partial(
        Displacement, np.outer(position, records.direction), records.sensors.step, period
    )
    if not conditions:
        return make(
            title=f"natural period {period:g} s",
            made_of="spectrum of Eq. (1)",
            size=f"{MEANING[config.normalise]} 1 m along the waves",
            given=config.spectrum.at(period),
            given_label="S(f), Eq. (1), scaled",
            peaks={},
        )
    return make(
        title=f"{PLANT.describe_values(conditions)}: natural period {period:.2f} s",
        made_of="answer of the structure to a sea",
        size=f"along the waves rms {position.std():.2f} m, largest displacement "
        f"{np.abs(position).max():.2f} m",
        given=translated(period),
        given_label="S(f), Eq. (1) with Table 4's\nwidth, scaled",
        peaks={"first mode": 1.0 / period, "peak of the waves": 1.0 / float(conditions["tp"])},
    )
