"""Figures 9-14 of Ren et al. (2019): one record in time, and what accumulates of the errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.decimate import decimate
from owtsweep.figures.palette import style_of
from owtsweep.studies.hub.histories import Histories

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: The schemes of the paper's figures; others are drawn if the run has none of them.
SHOWN = ("MKF", "HME1", "HME2")
#: s of the record that the histories show, from its start and in the zoom.
SPAN = 120.0
ZOOM = 15.0
#: The same of the acceleration, whose noise hides all else in a longer one.
ACCELERATION_ZOOM = 6.0
#: Points of one line: four lines in two panels make an SVG of some 400 KiB.
POINTS = 1200
AXES = ("x", "y")
TRUTH: dict[str, Any] = {"color": "black", "linewidth": 1.4, "label": "truth", "zorder": 2}
ALONE: dict[str, Any] = {
    "color": "#D55E00", "linewidth": 1.1, "linestyle": (0, (1, 1)), "zorder": 1.9,
    "label": "IMU alone,\nintegrated",
}  # fmt: skip
FIXES: dict[str, Any] = {
    "color": "0.45", "marker": "+", "linestyle": "none", "markersize": 7,
    "label": "GNSS fixes\n(as they arrive)", "zorder": 3,
}  # fmt: skip
#: What the integrated IMU may show of its drift, in amplitudes of the motion.
VIEW = 1.6
UNITS = {"position": "m", "velocity": "m/s", "acceleration": "m/s²", "bias": "m/s²"}
#: Bound of the velocity error that section 5.2 names, m/s.
VELOCITY_BOUND = 0.05


def draw(
    histories: Histories,
    quantity: str,
    *,
    zoom: bool = False,
    tuning: str,
    schemes: Sequence[str] | None = None,
) -> Figure:
    """Draw one quantity over time, x above y, and below them what accumulates of the errors.

    Parameters
    ----------
    histories
        As `owtsweep.studies.hub.histories.histories` makes them.
    quantity
        "position", "velocity", "acceleration" or "bias".
    zoom
        Show `ZOOM` s of the settled part, and the errors of x there in the lowest panel.
    tuning
        Named in the title.
    schemes
        Which to draw, by default those of `SHOWN` that the histories hold, or all.

    Raises
    ------
    InputError
        If there is no such quantity or no scheme to draw.
    """
    if quantity not in UNITS:
        raise InputError(f"quantity: {quantity!r} is none of {', '.join(UNITS)}")
    names = _names(histories, quantity, schemes)
    start, end = _window(histories, quantity, zoom=zoom)
    with style.context():
        figure = style.new_figure(10.0, 7.2)
        panels = figure.subplots(3, 1, height_ratios=[1.0, 1.0, 0.8])
        for axis, axes in enumerate(panels[:2]):
            _truth_and_sensors(axes, histories, quantity, axis, (start, end))
            for name in names:
                _line(
                    axes,
                    *_estimate(histories, name, quantity, axis),
                    name,
                    (start, end),
                    names=list(histories.estimated),
                )
            axes.set_xlim(start, end)
            axes.set_ylabel(f"{AXES[axis]} {quantity} ({UNITS[quantity]})")
            _limit(axes, histories, quantity, axis, (start, end), names)
        if zoom:
            _errors(panels[2], histories, quantity, names, (start, end))
        else:
            _accumulated(panels[2], histories, quantity, names)
        panels[2].set_xlabel("time (s)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper", frameon=False)
        figure.suptitle(
            f"{_title(quantity, zoom=zoom)}, natural period {histories.natural_period:g} s, "
            f"amplitude {histories.amplitude:g} m, tuning: {tuning}",
            x=0.01,
            ha="left",
            fontsize=12,
        )
        style.footnote(figure, _explanations(histories, quantity, names))
    return figure


def _names(histories: Histories, quantity: str, schemes: Sequence[str] | None) -> list[str]:
    if schemes is None:
        known = [name for name in histories.estimated if name in SHOWN]
        schemes = known or list(histories.estimated)
    for name in schemes:
        if name not in histories.estimated:
            have = ", ".join(histories.estimated) or "none"
            raise InputError(f"schemes: {name!r} was not run on this record; it has {have}")
    if quantity == "acceleration":
        schemes = [n for n in schemes if histories.estimated[n].acceleration is not None]
    if not schemes:
        raise InputError(f"schemes: none of this run estimates the {quantity}")
    return list(schemes)


def _window(histories: Histories, quantity: str, *, zoom: bool) -> tuple[float, float]:
    whole = float(histories.time[-1])
    if zoom or quantity == "acceleration":
        length = ACCELERATION_ZOOM if quantity == "acceleration" else ZOOM
        start = max(min(SPAN, whole) - length, 0.0)
        return start, min(start + length, whole)
    return 0.0, whole if quantity == "bias" else min(SPAN, whole)


def _estimate(histories: Histories, name: str, quantity: str, axis: int) -> tuple[Array, Array]:
    """Times and values of an estimate, each value at the moment that it is about."""
    found = histories.estimated[name]
    values = getattr(found, quantity)[:, axis]
    if quantity in ("position", "velocity"):
        return histories.time, values
    return histories.time[: len(values) - found.lag], values[found.lag :]


def _error(histories: Histories, name: str, quantity: str, axis: int) -> tuple[Array, Array]:
    time, values = _estimate(histories, name, quantity, axis)
    return time, values - getattr(histories, quantity)[: len(values), axis]


def _truth_and_sensors(
    axes: Axes, histories: Histories, quantity: str, axis: int, window: tuple[float, float]
) -> None:
    if quantity == "acceleration":
        measured: dict[str, Any] = {"color": "0.75", "linewidth": 0.6, "label": "IMU"}
        _plot(axes, histories.time, histories.measured[:, axis], window, **measured)
    _plot(axes, histories.time, getattr(histories, quantity)[:, axis], window, **TRUTH)
    if quantity in ("position", "velocity"):
        alone = getattr(histories, f"integrated_{quantity}")[:, axis]
        if _in_view(histories, quantity, axis, window):
            _plot(axes, histories.time, alone, window, **ALONE)
    if quantity == "position":
        inside = (histories.fix_time >= window[0]) & (histories.fix_time <= window[1])
        axes.plot(histories.fix_time[inside], histories.fixes[inside, axis], **FIXES)


def _plot(axes: Axes, time: Array, values: Array, window: tuple[float, float], **look: Any) -> None:
    inside = (time >= window[0]) & (time <= window[1])
    axes.plot(*decimate(time[inside], values[inside], POINTS), **look)


def _line(
    axes: Axes,
    time: Array,
    values: Array,
    name: str,
    window: tuple[float, float],
    *,
    names: Sequence[str],
) -> None:
    look = style_of(name, names)
    line: dict[str, Any] = {"color": look.color, "linestyle": look.line, "linewidth": 1.2}
    _plot(axes, time, values, window, label=name, zorder=2.5, **line)


def _limit(
    axes: Axes,
    histories: Histories,
    quantity: str,
    axis: int,
    window: tuple[float, float],
    names: Sequence[str],
) -> None:
    """Let the drift of the integrated IMU leave the panel, and say where to."""
    if quantity == "bias":
        settled = [_estimate(histories, name, quantity, axis)[1][_settled(histories) :]
                   for name in names]  # fmt: skip
        values = np.concatenate([histories.bias[:, axis], *settled])
        margin = 0.3 * np.ptp(values)
        axes.set_ylim(values.min() - margin, values.max() + margin)
    if quantity not in ("position", "velocity"):
        return
    alone = getattr(histories, f"integrated_{quantity}")[:, axis]
    limit = _view(histories, quantity, axis)
    if _in_view(histories, quantity, axis, window):
        axes.set_ylim(-limit, limit)
    last = int(np.searchsorted(histories.time, window[1], side="right")) - 1
    outside = np.abs(alone) > limit
    if outside[last]:
        gone = histories.time[int(np.argmax(outside))]
        axes.set_title(
            f"IMU alone, integrated: leaves ±{limit:.2g} {UNITS[quantity]} after {gone:.0f} s, "
            f"is at {alone[last]:.3g} {UNITS[quantity]} after {histories.time[last]:.0f} s",
            loc="left",
            fontsize=9,
            color=ALONE["color"],
        )


def _view(histories: Histories, quantity: str, axis: int) -> float:
    return VIEW * float(np.max(np.abs(getattr(histories, quantity)[:, axis])))


def _in_view(histories: Histories, quantity: str, axis: int, window: tuple[float, float]) -> bool:
    """Whether the integrated IMU has not left the panel before the window begins."""
    inside = (histories.time >= window[0]) & (histories.time <= window[1])
    alone = getattr(histories, f"integrated_{quantity}")[inside, axis]
    return bool(np.min(np.abs(alone)) <= _view(histories, quantity, axis))


def _settled(histories: Histories) -> int:
    """The first step of what a bias panel is scaled to: after a tenth of the record."""
    return len(histories.time) // 10


def _accumulated(axes: Axes, histories: Histories, quantity: str, names: Sequence[str]) -> None:
    """The absolute error of both axes, summed over time."""
    step = float(histories.time[1])
    ends = []
    for name in names:
        parts = [_error(histories, name, quantity, axis) for axis in range(2)]
        total = step * np.cumsum(np.sum([np.abs(error) for _, error in parts], axis=0))
        whole = (0.0, float(histories.time[-1]))
        _line(axes, parts[0][0], total, name, whole, names=list(histories.estimated))
        ends.append(f"{name} {total[-1]:.3g}")
    axes.set_ylabel(f"accumulated |error|,\nx + y ({_times_second(UNITS[quantity])})")
    at_end = ", ".join(ends)
    axes.set_title(f"over the whole record; at its end: {at_end}", loc="left", fontsize=9)
    axes.set_xlim(0.0, histories.time[-1])
    axes.set_ylim(bottom=0.0)


def _times_second(unit: str) -> str:
    return {"m": "m s", "m/s": "m", "m/s²": "m/s"}[unit]


def _errors(
    axes: Axes, histories: Histories, quantity: str, names: Sequence[str],
    window: tuple[float, float],
) -> None:  # fmt: skip
    for name in names:
        time, error = _error(histories, name, quantity, 0)
        _line(axes, time, error, name, window, names=list(histories.estimated))
    if quantity == "velocity":
        for bound in (-VELOCITY_BOUND, VELOCITY_BOUND):
            axes.axhline(bound, color="0.3", linewidth=1.0, linestyle=":")
        axes.set_title(f"dotted: ±{VELOCITY_BOUND:g} m/s of section 5.2", loc="left", fontsize=9)
    axes.axhline(0.0, color="0.3", linewidth=0.8)
    axes.set_ylabel(f"error of x ({UNITS[quantity]})")
    axes.set_xlim(*window)


def _title(quantity: str, *, zoom: bool) -> str:
    name = {"bias": "Accelerometer bias"}.get(quantity, quantity.capitalize())
    return f"{name} estimate{', zoomed in' if zoom else ''}"


def _explanations(histories: Histories, quantity: str, names: Sequence[str]) -> str:
    sentences = [
        f"The paper does not give the amplitude of its histories; {histories.amplitude:g} m is our"
        " choice (its text has HME1 ahead of HME2 there, and at 4 s only above 0.3 m)."
    ]
    if quantity == "position":
        sentences.append(f"A fix tells the position of {histories.delay:g} s before it arrives.")
    if quantity in ("position", "velocity"):
        sentences.append("The IMU alone is integrated from the true initial state.")
    else:
        lags: dict[float, list[str]] = {}
        for name in names:
            lag = histories.estimated[name].lag * float(histories.time[1])
            lags.setdefault(round(lag, 9), []).append(name)
        known = "; ".join(
            f"{' and '.join(group)} {f'{lag:g} s later' if lag else 'at once'}"
            for lag, group in sorted(lags.items())
        )
        sentences.append(
            f"Each value of the filter stands at the moment that it is about; it is known: {known}."
        )
        if any(histories.estimated[name].lag == 0 for name in names):
            sentences.append(
                "A filter without delay mixes fixes of the past with an IMU of the present."
            )
    if quantity == "bias":
        sentences.append("Panels of x and y are scaled to what is left after the transient.")
    if quantity in ("acceleration", "bias") and len(names) > 1:
        sentences.append("Where one line shows, the others lie under it.")
    sentences += [f"{name} is left out: {why}." for name, why in histories.left_out.items()]
    return " ".join(sentences)
