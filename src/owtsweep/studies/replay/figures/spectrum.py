"""A record's spectrum with Eq. (1) as it was fitted."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.errors import InputError
from owtsweep.studies.hub.figures import style
from owtsweep.studies.hub.schemes import resolve_all
from owtsweep.studies.replay.blocks import describer
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.facts import displacement
from owtsweep.studies.replay.place import fitted
from owtsweep.studies.replay.session import Session

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Hz over the upper edge of the band that the figure reaches.
BEYOND = 2.0


def draw(config: ReplayConfig, session: Session, record: Any) -> Figure:
    """Periodogram of the displacement along its main direction, its smooth form, and the fit."""
    settled = round(config.measures.settling_time / session.sensors.step)
    scheme = resolve_all(config.schemes, config)[describer(config)]
    found = displacement(config, session.record, session.sensors, scheme, settled)
    d, step = found.values, session.sensors.step
    n = len(d)
    if not np.any(d):
        raise InputError("the record does not move, so it has no spectrum")
    frequency = np.fft.rfftfreq(n, step)[1:]
    power = np.abs(np.fft.rfft(d * _taper(n)))[1:] ** 2 * 2.0 * step / np.sum(_taper(n) ** 2)
    low, high = config.band
    shown = (frequency >= low / 2.0) & (frequency <= BEYOND * high)
    with style.context():
        figure = style.new_figure(9.0, 4.8)
        axes = figure.add_subplot()
        axes.axvspan(low, high, color="0.95", zorder=0)
        axes.plot(
            frequency[shown], power[shown], color="0.65", linewidth=0.8,
            label="periodogram (Hann taper)",
        )  # fmt: skip
        shape = fitted(record)
        if shape is not None:
            f = np.linspace(low, high, 2000)
            axes.plot(f, shape.density(f), color="#0072B2", linewidth=1.8, label="Eq. (1), fitted")
            axes.axvline(shape.peak_frequency, color="#0072B2", linewidth=0.9, linestyle=":")
        axes.set_yscale("log")
        top = float(np.max(power[shown]))
        axes.set_ylim(1e-7 * top, 5.0 * top)
        axes.set_xlim(low / 2.0, BEYOND * high)
        axes.set_xlabel("frequency (Hz)")
        axes.set_ylabel("displacement spectrum (m²/Hz)")
        axes.legend(loc="upper right", frameon=False)
        axes.set_title(
            f"Spectrum of {Path(session.record.file).name}\n{_said(record, shape is not None)}",
            loc="left",
        )
        style.footnote(
            figure,
            f"Displacement along {record['direction']:.0f} deg from x, which carries "
            f"{100 * record['direction_share']:.0f} % of the horizontal variance, from "
            f"{found.source}. Grey: band [{low:g}, {high:g}] Hz, where Eq. (1) is fitted by "
            "Whittle likelihood.",
        )
    return figure


def _taper(n: int) -> Any:
    return np.hanning(n)


def _said(record: Any, has_fit: bool) -> str:
    if not has_fit:
        return "Eq. (1) could not be fitted inside the band"
    text = f"natural period {record['spectrum_natural_period']:.3g}"
    error = record.get("spectrum_natural_period_se", np.nan)
    if np.isfinite(error):
        text += f" ± {1.96 * error:.1g}"
    return f"{text} s, half-bandwidth {record['spectrum_half_bandwidth']:.2g} Hz"
