"""Draws each scheme's error from motion against frequency, and its error from sensor noise alone.

The figure shows which of the two errors makes a scheme win.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import NullFormatter

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.palette import style_of
from owtsweep.studies.base.schemes import StoredScheme
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve_all
from owtsweep.studies.hub.error_spectrum import ErrorSpectrum, error_spectrum
from owtsweep.studies.hub.noise_floor import NoiseFloor, noise_floor

#: Points of a curve, evenly spaced in log frequency.
POINTS = 150
#: Curves extend beyond the lower and upper edge of the band by these factors, but stay below the
#: fix rate.
BEYOND = (0.7, 1.4)
#: The axis shows errors down to this many decades below the largest.
DECADES = 7.5
#: The noise floors are drawn to the right of the band, in this part of the axis (axis fractions).
FLOOR_SPAN = (0.9, 1.0)
UNITS = {"position": "m²", "velocity": "m²/s²"}


@dataclass(frozen=True)
class SchemeErrors:
    """A scheme's settled errors: from motion at each frequency, and from noise if these settle."""

    spectrum: ErrorSpectrum
    floor: NoiseFloor | None


def compute(config: HubConfig, *, points: int = POINTS) -> dict[str, SchemeErrors]:
    """Return scheme -> the settled errors of the scheme, from motion and from sensor noise.

    A scheme is left out if it has no kernel, if its response to motion does not settle, or if it is
    code of a stored run's author (such code is not run); see `unsettled`. `points` is the number of
    frequencies; a few near multiples of the fix rate are dropped.
    """
    sensors = sensing.sensors(config.sensors)
    low, high = config.band
    # to the GNSS, a motion at a multiple of the fix rate is like rest
    highest = min(BEYOND[1] * high, max(high, 0.95 / sensors.fix_step))
    frequency = np.geomspace(BEYOND[0] * low, highest, points)
    phase = frequency * sensors.fix_step
    frequency = frequency[np.abs(phase - np.round(phase)) > 0.02]
    errors: dict[str, SchemeErrors] = {}
    for scheme in resolve_all(config.schemes, config):
        if scheme.batched != "chain":
            continue
        with suppress(InputError):
            chain = scheme.kernel(Known(sensors, config))
            spectrum, floor = error_spectrum(chain, sensors, frequency), None
            with suppress(InputError):
                floor = noise_floor(chain, sensors)
            errors[scheme.name] = SchemeErrors(spectrum, floor)
    return errors


def draw(
    config: HubConfig,
    *,
    coinciding: Sequence[Sequence[str]] = (),
    errors: dict[str, SchemeErrors] | None = None,
    motion: bool = False,
) -> Figure:
    """Draw the schemes' errors from motion and from sensor noise: position left, velocity right.

    coinciding: groups of schemes with equal results, for the footnote.
    errors: the result of `compute`; None to compute the errors here.
    motion: whether to draw below the spectra of the motion at the grid's natural periods.
    Raises InputError if no scheme of the study has an error spectrum.
    """
    shown = compute(config) if errors is None else errors
    figure = style.new_figure(10.0, 6.6 if motion else 5.2)
    ratios = [3.4, 1.0] if motion else [1.0]
    grid = figure.subplots(len(ratios), 2, squeeze=False, height_ratios=ratios)
    for axes, measure in zip(grid[0], UNITS, strict=True):
        panel(axes, shown, config, measure)
    for axes in grid[1] if motion else ():
        _draw_motion_spectra(axes, config, grid[0, 0].get_xlim())
    handles, labels = grid[0, 0].get_legend_handles_labels()
    figure.legend(handles, labels, loc="outside right upper", frameon=False)
    title = "What a motion of 1 m rms adds to the settled MSE, by its frequency, tuning: "
    figure.suptitle(f"{title}{config.tuning_name}", x=0.01, ha="left", fontsize=12)
    same = [f"{' and '.join(group)} give the same numbers." for group in coinciding]
    below = [MOTION_EXPLANATION] if motion else []
    style.footnote(figure, " ".join([EXPLANATION, *below, *same, *unsettled(config, shown)]))
    return figure


EXPLANATION = (
    "Curves: error from motion alone, for a sinusoid of 1 m rms along the waves; s m rms moves them"
    " by s². Bars on the right: error from sensor noise alone, at any motion. The MSE of a record"
    " is the average of the curve over its spectrum, times its mean square, plus the bar. Both are"
    " settled: the start-up transient of a record is in neither. Curves may go on below a panel."
)

MOTION_EXPLANATION = (
    "Below: spectra of the motion at the grid's natural periods, each with its peak at 1."
)
#: Greatest number of motion spectra drawn; more would hide each other.
MOST_SPECTRA = 8


def _draw_motion_spectra(axes: Axes, config: HubConfig, limits: tuple[float, float]) -> None:
    """Draw up to `MOST_SPECTRA` spectra of the motion, each scaled to a peak of 1; limits in Hz."""
    periods = sorted(config.grid.natural_period)
    chosen = np.unique(np.linspace(0, len(periods) - 1, MOST_SPECTRA).round().astype(int))
    frequency = np.geomspace(config.band[0], config.band[1], 2000)
    shown = [periods[i] for i in chosen]
    for number, period in enumerate(shown):
        shape = config.spectrum.at(period)
        density = shape.density(frequency) / shape.density(np.array([shape.peak_frequency]))
        grey = str(0.15 + 0.5 * number / max(len(shown) - 1, 1))
        axes.loglog(frequency, density, color=grey, linewidth=1.0)
    axes.set_xlim(*limits)
    axes.set_ylim(1e-4, 2.0)
    _frequency_ticks(axes, limits[0], BEYOND[1] * config.band[1])
    axes.set_xlabel("frequency of the motion (Hz)")
    axes.set_ylabel("motion spectrum\n(its peak is 1)")


def unsettled(config: HubConfig, errors: dict[str, SchemeErrors]) -> list[str]:
    """Say which schemes lack a curve or a noise floor in what `compute` returned, and why."""
    missing = [s for s in resolve_all(config.schemes, config) if s.name not in errors]
    theirs = [scheme.name for scheme in missing if isinstance(scheme, StoredScheme)]
    ours = [scheme.name for scheme in missing if not isinstance(scheme, StoredScheme)]
    without = {
        "curve (no kernel whose gains serve all motions, or it does not settle)": ours,
        "curve (code of the run's author is not run)": theirs,
        "bar (the noise does not settle)": [n for n in errors if errors[n].floor is None],
    }
    return [
        f"{config.tuning_name}: no {what} for {', '.join(lacking)}."
        for what, lacking in without.items()
        if lacking
    ]


def panel(axes: Axes, errors: dict[str, SchemeErrors], config: HubConfig, measure: str) -> None:
    """Draw one measure's errors from motion, against frequency, and its errors from noise.

    Both axes are logarithmic; the grid's natural periods are marked. `errors` is the result of
    `compute`. Raises InputError if it is empty.
    """
    if not errors:
        raise InputError(
            "schemes: none of this run has a settled error spectrum to draw; use EKF, MKF, HME1 or "
            f"HME2, or a tuning other than {config.tuning!r}"
        )
    names = list(errors)
    for name, of_scheme in errors.items():
        drawn, spectrum = style_of(name, names), of_scheme.spectrum
        line: style.Look = {"color": drawn.color, "linestyle": drawn.line}
        curve = spectrum.frequency, spectrum.of(measure)
        axes.loglog(*curve, label=style.label_of(name), linewidth=1.6, **line)
        if of_scheme.floor is not None:
            line |= {"linewidth": 2.2, "transform": axes.get_yaxis_transform()}
            axes.plot(FLOOR_SPAN, [of_scheme.floor.of(measure)] * 2, **line)
    _scale(axes, [of_scheme.spectrum for of_scheme in errors.values()], config, measure)
    _mark_periods(axes, config.grid.natural_period)
    axes.set_ylabel(f"{measure} MSE, x + y ({UNITS[measure]})")


def _scale(axes: Axes, spectra: Sequence[ErrorSpectrum], config: HubConfig, measure: str) -> None:
    frequency, values = spectra[0].frequency, [spectrum.of(measure) for spectrum in spectra]
    left, right = np.log(frequency[0]), np.log(frequency[-1])
    # room for the bars: they begin where the curves end
    end = left + (right - left) / (FLOOR_SPAN[0] - 0.02)
    axes.set_xlim(frequency[0], np.exp(end))
    least, top = float(np.min(values)), float(np.max(values))
    axes.set_ylim(max(0.3 * least, top / 10.0**DECADES), 4.0 * top)
    axes.axvline(np.exp(left + FLOOR_SPAN[0] * (end - left) - 0.01), color="0.6", linewidth=0.8)
    axes.text(0.5 * sum(FLOOR_SPAN), 0.02, "noise\nalone", transform=axes.transAxes,
              ha="center", va="bottom", fontsize=8)  # fmt: skip
    axes.axvspan(*config.band, color="0.95", zorder=0)
    _frequency_ticks(axes, frequency[0], frequency[-1])
    axes.set_xlabel("frequency of the motion (Hz); grey: band of the records")


def _frequency_ticks(axes: Axes, low: float, high: float) -> None:
    axes.set_xticks([f for f in (0.05, 0.1, 0.2, 0.3, 0.4, 0.6, 1.0) if low <= f <= high])
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())


def _mark_periods(axes: Axes, periods: Sequence[float]) -> None:
    """Mark natural periods (s) on the frequency axis by dotted lines, and ticks at the top."""
    low, high = axes.get_xlim()
    shown = [period for period in periods if low < 1.0 / period < high]
    for period in shown:
        axes.axvline(1.0 / period, color="0.7", linewidth=0.7, linestyle=":", zorder=0.5)
    upper = axes.secondary_xaxis("top")
    upper.set_xticks([1.0 / period for period in shown], [f"{period:g}" for period in shown])
    upper.minorticks_off()
    upper.tick_params(labelsize=8, length=2, pad=1)
    upper.set_xlabel("natural period (s)", fontsize=8)
    upper.spines["top"].set_visible(False)
