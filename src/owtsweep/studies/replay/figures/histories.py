"""A record in time, as figures 9-14 of Ren et al. (2019): truth, fixes, estimates, errors."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.decimate import decimate
from owtsweep.figures.palette import style_of
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.envelope import POINTS
from owtsweep.studies.replay.figures.traces import Line, Traces, traces
from owtsweep.studies.replay.measures import QUANTILE
from owtsweep.studies.replay.session import Session
from owtsweep.studies.replay.states import FilterStates

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

UNITS = {"position": "m", "velocity": "m/s", "acceleration": "m/s²", "bias": "m/s²"}


def draw(
    config: ReplayConfig,
    session: Session,
    states: FilterStates,
    quantity: str,
    *,
    zoom: bool,
    advised: str | None,
) -> Figure:
    """Draw one quantity over time: x, y, and below them the errors of x.

    Parameters
    ----------
    states
        What the filters believe besides.
    quantity
        "position", "velocity", "acceleration" or "bias".
    zoom
        Show some seconds about the largest motion after settling.
    advised
        The scheme that is drawn with its ±1.96 standard deviations.

    Raises
    ------
    InputError
        If no scheme estimates the quantity.
    """
    shown = traces(session, states, quantity, zoom=zoom)
    if not shown.lines:
        hint = "" if quantity in ("position", "velocity") else "; kernels give one with every fix"
        raise InputError(f"there is no estimate of {quantity} here{hint}")
    with style.context():
        panels_below = shown.truth is not None or quantity == "position"
        figure = style.new_figure(10.0, 7.2 if panels_below else 5.4)
        panels = figure.subplots(
            3 if panels_below else 2, 1, height_ratios=[1, 1, 0.8][: 3 if panels_below else 2],
            sharex=True,
        )  # fmt: skip
        for axis, axes in enumerate(panels[:2]):
            _values(axes, session, quantity, axis, shown)
            axes.set_ylabel(f"{'xy'[axis]} {quantity} ({UNITS[quantity]})")
        if shown.truth is not None:
            _errors(panels[2], session, quantity, shown, advised)
        elif panels_below:
            _innovations(panels[2], session, shown)
        panels[-1].set_xlim(shown.start, shown.end)
        panels[-1].set_xlabel("time on the file's clock (s)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper", frameon=False)
        name = {"bias": "Accelerometer bias"}.get(quantity, quantity.capitalize())
        figure.suptitle(
            f"{name}{_part(session, shown, zoom=zoom)}: {Path(session.record.file).name}, "
            f"tuning: {config.tuning}",
            x=0.01, ha="left", fontsize=12,
        )  # fmt: skip
        style.footnote(figure, _explanations(session, quantity, shown))
    return figure


def _part(session: Session, shown: Traces, *, zoom: bool) -> str:
    """Which part of the record a figure shows, in words, unless it is all of it."""
    if zoom:
        return ", zoomed in"
    length = session.record.steps * session.record.step
    part = shown.end - shown.start
    return f", the first {part:.3g} s of {_duration(length)}" if part < 0.99 * length else ""


def _duration(seconds: float) -> str:
    for unit, size in (("h", 3600.0), ("min", 60.0)):
        if seconds >= 2.0 * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} s"


def _plot(axes: Axes, line: Line, **look: Any) -> None:
    """A line in its pieces; a gap stays a gap."""
    for time, values in line:
        axes.plot(time, values, **look)
        look = {key: item for key, item in look.items() if key != "label"}


def _values(axes: Axes, session: Session, quantity: str, axis: int, shown: Traces) -> None:
    if shown.imu is not None:
        _plot(axes, shown.imu[axis], color="0.75", linewidth=0.6, label="IMU")
    if shown.truth is not None:
        label = session.record.truth if quantity != "bias" else "simulated bias"
        _plot(axes, shown.truth[axis], color="black", linewidth=1.4, label=label)
    for name, line in shown.lines.items():
        look = style_of(name, session.names)
        _plot(
            axes, line[axis], color=look.color, linestyle=look.line, linewidth=1.2, label=name,
            zorder=2.5,
        )  # fmt: skip
    if shown.fixes is not None:
        time, fixes = shown.fixes
        axes.plot(
            time, fixes[:, axis], color="0.45", marker="+", linestyle="none", markersize=6,
            label="fixes\n(as they arrive)", zorder=3,
        )  # fmt: skip
    if shown.limits is not None:  # the start, from an uncertain guess, would hide the rest
        low, high = shown.limits[axis]
        axes.set_ylim(low - 0.3 * (high - low), high + 0.3 * (high - low))


def _errors(
    axes: Axes, session: Session, quantity: str, shown: Traces, advised: str | None
) -> None:
    title = ""
    if advised is not None and advised in shown.deviations:
        time, deviation = shown.deviations[advised]
        if np.any(np.isfinite(deviation)):
            color = style_of(advised, session.names).color
            at, low = decimate(time, -QUANTILE * deviation, POINTS)
            high = np.interp(at, time, QUANTILE * deviation)
            axes.fill_between(at, low, high, color=color, alpha=0.15, linewidth=0)
            title = f"shaded: ±1.96 standard deviations that {advised} states"
    for name, line in shown.errors.items():
        look = style_of(name, session.names)
        _plot(axes, line, color=look.color, linestyle=look.line, linewidth=1.1)
    axes.axhline(0.0, color="0.3", linewidth=0.8)
    axes.set_ylim(-1.2 * shown.bound, 1.2 * shown.bound)
    axes.set_ylabel(f"error of x ({UNITS[quantity]})")
    if title:
        axes.set_title(title, loc="left", fontsize=9)


def _innovations(axes: Axes, session: Session, shown: Traces) -> None:
    """Without a truth: how far each fix was from what the filter had expected, in its sigma."""
    for name, (time, scaled) in shown.innovations.items():
        look = style_of(name, session.names)
        axes.plot(
            *decimate(time, scaled, POINTS), color=look.color, marker=look.marker, markersize=3,
            linewidth=0.6,
        )  # fmt: skip
    for bound in (-QUANTILE, QUANTILE):
        axes.axhline(bound, color="0.3", linewidth=1.0, linestyle=":")
    axes.set_ylim(-6.0, 6.0)
    axes.set_ylabel("innovation of x\n(standard deviations)")
    axes.set_title("dotted: 95 % lie inside if the filter knows its noise", loc="left", fontsize=9)


def _explanations(session: Session, quantity: str, shown: Traces) -> str:
    sentences = []
    left = [name for name in session.names if name not in shown.lines]
    if quantity in ("position", "velocity") and left:
        sentences.append(f"{' and '.join(left)}: the same line as one that is drawn.")
    if quantity == "position":
        delay = session.sensors.delay * session.sensors.step
        sentences.append(f"A fix tells the position of {delay:g} s before it arrives.")
        sentences += {
            "recorded": [],
            "from_reference": [
                "Fixes were made from the reference, with simulated noise; the IMU is recorded."
            ],
            "simulated": ["Fixes and IMU are simulated from the recorded motion (replicate 0)."],
        }[session.record.gnss]
        if np.any(session.record.origin != 0.0):
            x, y = session.record.origin
            sentences.append(f"The mean position ({x:.3g}, {y:.3g}) m is taken off.")
    if quantity in ("acceleration", "bias"):
        sentences.append("Each value of the filter stands at the moment that it is about.")
    if quantity == "bias" and session.record.steps > POINTS:
        every = 2.0 * session.record.steps / POINTS * session.record.step
        sentences.append(f"Drawn are the least and the greatest value of every {every:.3g} s.")
    if quantity == "bias" and shown.truth is None:
        sentences.append("It holds whatever the IMU reports besides motion: leaks of gravity too.")
    sentences += [f"{name} is left out: {why}." for name, why in session.failed.items()]
    return " ".join(sentences)
