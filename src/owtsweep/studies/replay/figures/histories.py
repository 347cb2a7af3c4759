"""A record in time, as figures 9-14 of Ren et al. (2019): truth, fixes, estimates, errors."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.studies.hub.figures import style
from owtsweep.studies.hub.figures.decimate import decimate
from owtsweep.studies.hub.palette import style_of
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.measures import QUANTILE
from owtsweep.studies.replay.session import Session
from owtsweep.studies.replay.states import FilterStates, filter_states

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

#: s that the whole and the zoomed views show at most.
SPAN, ZOOM, ACCELERATION_ZOOM = 200.0, 15.0, 6.0
POINTS = 1200
UNITS = {"position": "m", "velocity": "m/s", "acceleration": "m/s²", "bias": "m/s²"}


def draw(
    config: ReplayConfig, session: Session, quantity: str, *, zoom: bool, advised: str | None
) -> Figure:
    """Draw one quantity over time: x, y, and below them the errors of x.

    Parameters
    ----------
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
    lines = _lines(config, session, quantity)
    if not lines:
        hint = "" if quantity in ("position", "velocity") else "; kernels give one with every fix"
        raise InputError(f"there is no estimate of {quantity} here{hint}")
    time = session.record.time
    start, end = _window(session, quantity, zoom=zoom)
    shown = (time >= start) & (time <= end)
    truth = _truth(config, session, quantity)
    with style.context():
        panels_below = truth is not None or quantity == "position"
        figure = style.new_figure(10.0, 7.2 if panels_below else 5.4)
        panels = figure.subplots(
            3 if panels_below else 2, 1, height_ratios=[1, 1, 0.8][: 3 if panels_below else 2],
            sharex=True,
        )  # fmt: skip
        for axis, axes in enumerate(panels[:2]):
            _values(axes, session, quantity, axis, lines, truth, shown, advised)
            axes.set_ylabel(f"{'xy'[axis]} {quantity} ({UNITS[quantity]})")
        if truth is not None:
            _errors(panels[2], session, quantity, lines, truth, shown, advised)
        elif panels_below:
            _innovations(panels[2], session, shown)
        panels[-1].set_xlim(start, end)
        panels[-1].set_xlabel("time on the file's clock (s)")
        handles, labels = panels[0].get_legend_handles_labels()
        figure.legend(handles, labels, loc="outside right upper", frameon=False)
        name = {"bias": "Accelerometer bias"}.get(quantity, quantity.capitalize())
        figure.suptitle(
            f"{name}{', zoomed in' if zoom else ''}: {Path(session.record.file).name}, "
            f"tuning: {config.tuning}",
            x=0.01, ha="left", fontsize=12,
        )  # fmt: skip
        style.footnote(figure, _explanations(session, quantity, lines, truth is not None))
    return figure


def _lines(config: ReplayConfig, session: Session, quantity: str) -> dict[str, Array]:
    """Scheme -> (steps, 2); of schemes that are one and the same the last one."""
    if quantity in ("position", "velocity"):
        part = slice(0, 2) if quantity == "position" else slice(2, 4)
        found = {name: e.state[:, part] for name, e in session.estimated.items()}
    else:
        states: dict[str, FilterStates] = filter_states(config, session)
        found = {
            name: series
            for name, known in states.items()
            if (series := getattr(known, quantity)) is not None
        }
    names = list(found)
    return {
        name: found[name]
        for i, name in enumerate(names)
        if not any(_same(found[name], found[other]) for other in names[i + 1 :])
    }


def _same(one: Array, other: Array) -> bool:
    return bool(np.allclose(one, other, rtol=1e-9, atol=1e-12, equal_nan=True))


def _truth(config: ReplayConfig, session: Session, quantity: str) -> Array | None:
    if quantity == "bias":
        if session.record.kind != "motion":
            return None
        from owtsweep.studies.replay.measuring import simulated_bias

        return simulated_bias(config, session.sensors, session.record, 0)
    series: Array | None = getattr(session.record, quantity)
    return series


def _window(session: Session, quantity: str, *, zoom: bool) -> tuple[float, float]:
    time = session.record.time
    if not zoom:
        last = time[-1] if quantity == "bias" else min(time[0] + SPAN, time[-1])
        return float(time[0]), float(last)
    length = ACCELERATION_ZOOM if quantity == "acceleration" else ZOOM
    xy = session.record.position
    if xy is None:
        xy = next(iter(session.estimated.values())).state[:, :2]
    inside = (time >= time[0] + 20.0 + length / 2) & (time <= time[-1] - length / 2)
    size = np.where(inside & np.isfinite(xy[:, 0]), np.hypot(xy[:, 0], xy[:, 1]), -1.0)
    middle = float(time[int(np.argmax(size))]) if np.any(size > 0) else float(time[len(time) // 2])
    start = max(middle - length / 2, float(time[0]))
    return start, min(start + length, float(time[-1]))


def _plot(axes: Axes, time: Array, values: Array, **look: Any) -> None:
    """A line, decimated; a gap stays a gap."""
    there = np.isfinite(values)
    if np.all(there):
        axes.plot(*decimate(time, values, POINTS), **look)
        return
    edges = np.flatnonzero(np.diff(np.concatenate([[0], there.astype(int), [0]])))
    for begin, end in zip(edges[::2], edges[1::2], strict=True):
        share = max(int(POINTS * (end - begin) / len(values)), 8)
        axes.plot(*decimate(time[begin:end], values[begin:end], share), **look)
        look = {key: item for key, item in look.items() if key != "label"}


def _values(
    axes: Axes, session: Session, quantity: str, axis: int, lines: dict[str, Array],
    truth: Array | None, shown: Any, advised: str | None,
) -> None:  # fmt: skip
    time = session.record.time[shown]
    if quantity == "acceleration":
        force = session.measured.specific_force @ session.sensors.rotation.T
        measured = (force + np.array(session.sensors.gravity))[shown, axis]
        _plot(axes, time, measured, color="0.75", linewidth=0.6, label="IMU")
    if truth is not None:
        label = session.record.truth if quantity != "bias" else "simulated bias"
        _plot(axes, time, truth[shown, axis], color="black", linewidth=1.4, label=label)
    for name, values in lines.items():
        look = style_of(name, list(session.estimated))
        _plot(
            axes, time, values[shown, axis], color=look.color, linestyle=look.line, linewidth=1.2,
            label=name, zorder=2.5,
        )  # fmt: skip
    if quantity == "position":
        due = session.sensors.fix_interval * np.arange(len(session.measured.fixes))
        kept = shown[due]
        axes.plot(
            session.record.time[due[kept]], session.measured.fixes[kept, axis], color="0.45",
            marker="+", linestyle="none", markersize=6, label="fixes\n(as they arrive)", zorder=3,
        )  # fmt: skip
    if quantity == "bias":  # the start, from an uncertain guess, would hide the rest
        later = [v[len(v) // 5 :, axis] for v in lines.values()]
        values = np.concatenate([*later, *([] if truth is None else [truth[:, axis]])])
        low, high = float(np.nanmin(values)), float(np.nanmax(values))
        axes.set_ylim(low - 0.3 * (high - low), high + 0.3 * (high - low))


def _errors(
    axes: Axes, session: Session, quantity: str, lines: dict[str, Array], truth: Array,
    shown: Any, advised: str | None,
) -> None:  # fmt: skip
    time = session.record.time[shown]
    index = {"position": 0, "velocity": 2}.get(quantity)
    title = ""
    if advised in lines and index is not None:
        deviation = session.estimated[advised].deviation[shown, index]
        if np.any(np.isfinite(deviation)):
            color = style_of(advised, list(session.estimated)).color
            at, low = decimate(time, -QUANTILE * deviation, POINTS)
            high = np.interp(at, time, QUANTILE * deviation)
            axes.fill_between(at, low, high, color=color, alpha=0.15, linewidth=0)
            title = f"shaded: ±1.96 standard deviations that {advised} states"
    for name, values in lines.items():
        look = style_of(name, list(session.estimated))
        error = (values - truth)[shown, 0]
        _plot(axes, time, error, color=look.color, linestyle=look.line, linewidth=1.1)
    axes.axhline(0.0, color="0.3", linewidth=0.8)
    settled = np.concatenate([(v - truth)[len(truth) // 5 :, 0] for v in lines.values()])
    bound = 1.2 * float(np.nanmax(np.abs(settled)))
    axes.set_ylim(-bound, bound)
    axes.set_ylabel(f"error of x ({UNITS[quantity]})")
    if title:
        axes.set_title(title, loc="left", fontsize=9)


def _innovations(axes: Axes, session: Session, shown: Any) -> None:
    """Without a truth: how far each fix was from what the filter had expected, in its sigma."""
    time = session.record.time
    for name, estimated in session.estimated.items():
        if estimated.innovation is None or estimated.innovation_variance is None:
            continue
        look = style_of(name, list(session.estimated))
        scaled = estimated.innovation[:, 0] / np.sqrt(estimated.innovation_variance[:, 0])
        kept = shown & np.isfinite(scaled)
        at, values = decimate(time[kept], scaled[kept], POINTS)
        axes.plot(at, values, color=look.color, marker=look.marker, markersize=3, linewidth=0.6)
    for bound in (-QUANTILE, QUANTILE):
        axes.axhline(bound, color="0.3", linewidth=1.0, linestyle=":")
    axes.set_ylim(-6.0, 6.0)
    axes.set_ylabel("innovation of x\n(standard deviations)")
    axes.set_title("dotted: 95 % lie inside if the filter knows its noise", loc="left", fontsize=9)


def _explanations(session: Session, quantity: str, lines: dict[str, Array], has_truth: bool) -> str:
    sentences = []
    left = [name for name in session.estimated if name not in lines]
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
    if quantity == "bias" and not has_truth:
        sentences.append("It holds whatever the IMU reports besides motion: leaks of gravity too.")
    sentences += [f"{name} is left out: {why}." for name, why in session.failed.items()]
    return " ".join(sentences)
