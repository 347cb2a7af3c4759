"""Draw truth, fixes, estimates and errors over time, like figures 9-14 of Ren et al. (2019)."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from matplotlib.figure import Figure

from owtsweep.errors import InputError
from owtsweep.figures import time_histories
from owtsweep.figures.lines import POINTS, decimate, leaves
from owtsweep.figures.palette import style_of
from owtsweep.figures.style import Look
from owtsweep.figures.time_histories import UNITS, Band, Curve, Level, Panel
from owtsweep.studies.replay.figures.traces import Session, Traces, collect_traces
from owtsweep.studies.replay.files import name_file
from owtsweep.studies.replay.measures import QUANTILE

#: The panel of distances from later fixes shows those up to this many standard deviations.
REACH = 6.0


def draw(session: Session, quantity: str, *, zoom: bool) -> Figure:
    """Draw a quantity over time: a panel for x, a panel for y, and a panel for the errors of x.

    If the truth is unknown, distances from later fixes take the place of position errors.

    zoom: whether to show only some seconds around the largest motion after settling.
    Raises InputError if no scheme estimates the quantity.
    """
    shown = collect_traces(session, quantity, zoom=zoom)
    if not shown.lines:
        hint = ""
        if quantity not in ("position", "velocity"):
            hint = "; only schemes with kernels do, and only if no position fix is missing"
        raise InputError(f"no scheme estimates the {quantity} of this record{hint}")
    panels = [_make_values_panel(session, quantity, axis, shown) for axis in range(2)]
    if shown.truth is not None:
        panels.append(_make_errors_panel(session, quantity, shown))
    elif shown.residuals:
        panels.append(_make_residuals_panel(session, shown))
    left_out = {n: why for n, why in session.failed.items() if n not in session.names}
    notes = [
        *_explain(session, quantity, shown),
        *(f"{name} is left out: {why}." for name, why in left_out.items()),
    ]
    return time_histories.draw(
        panels,
        title=f"{time_histories.describe(quantity)}{_name_part(session, shown, zoom=zoom)}\n"
        f"{name_file(session.record.file)}, tuning: {session.config.tuning}",
        footnote=" ".join(notes),
        time_label="time on the file's clock (s)",
        shared=True,
    )


def _name_part(session: Session, shown: Traces, *, zoom: bool) -> str:
    length = session.record.steps * session.record.step
    part = shown.view[1] - shown.view[0]
    if part >= 0.99 * length:
        return ""
    seen = f"{part:.3g} s of {_format_duration(length)}"
    return f", {seen} around the largest motion after the start" if zoom else f", the first {seen}"


def _format_duration(seconds: float) -> str:
    for unit, size, least in (("h", 3600.0, 2.0), ("min", 60.0, 10.0)):
        if seconds >= least * size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds:.3g} s"


def _make_values_panel(session: Session, quantity: str, axis: int, shown: Traces) -> Panel:
    marks: list[Curve] = []
    if shown.imu is not None:
        marks.append(time_histories.show_measurement(shown.imu[axis]))
    if shown.truth is not None:
        label = session.record.truth if quantity != "bias" else "simulated bias"
        marks.append(time_histories.show_truth(shown.truth[axis], label))
    marks += [
        time_histories.show_estimate(
            name, session.names, pair[axis], on_top=name == session.advised
        )
        for name, pair in shown.lines.items()
    ]
    if shown.fixes is not None:
        time, fixes = shown.fixes
        label = "fixes\n(as they arrive)"
        marks.append(time_histories.show_fixes(time, fixes[:, axis], label=label, size=6))
    # the large values of a bias at the start would hide the rest
    limits = _find_limits(shown, axis) if quantity == "bias" else (None, None)
    return Panel(f"{'xy'[axis]} {quantity} ({UNITS[quantity]})", marks, shown.view, limits)


def _find_limits(shown: Traces, axis: int) -> tuple[float, float]:
    pairs = [*shown.lines.values(), *([shown.truth] if shown.truth else [])]
    low, high = shown.find_range(pair[axis] for pair in pairs)
    margin = 0.3 * (high - low)
    return low - margin, high + margin


def _make_errors_panel(session: Session, quantity: str, shown: Traces) -> Panel:
    marks: list[Band | Curve | Level] = []
    notes, advised = [], session.advised
    if advised is not None and advised in shown.deviations:
        time, deviation = shown.deviations[advised]
        if np.any(np.isfinite(deviation)):
            at, low = decimate(time, -QUANTILE * deviation, POINTS)
            high = np.interp(at, time, QUANTILE * deviation)
            marks.append(Band(at, low, high, style_of(advised, session.names).color))
            notes.append(f"shaded: ±1.96 standard deviations that {advised} states")
    for name, line in shown.errors.items():
        zorder = time_histories.ON_TOP if name == advised else 2.5
        look: Look = {"linewidth": 1.1, "zorder": zorder}
        marks.append(time_histories.show_scheme(name, session.names, line, look))
    reach = 1.2 * max(map(abs, shown.find_range(shown.errors.values())))
    if any(leaves(line, -reach, reach) for line in shown.errors.values()):
        notes.append(f"not shown: errors beyond ±{reach:.2g} {UNITS[quantity]} at the start")
    label = f"error of x ({UNITS[quantity]})"
    return Panel(label, [*marks, Level(0.0)], shown.view, (-reach, reach), "; ".join(notes))


def _make_residuals_panel(session: Session, shown: Traces) -> Panel:
    marks: list[Curve | Level] = []
    for name, (time, scaled) in shown.residuals.items():
        scheme = style_of(name, session.names)
        look: Look = {"color": scheme.color, "marker": scheme.marker}
        look |= {"markersize": 3, "linewidth": 0.6}
        marks.append(Curve([decimate(time, scaled, POINTS)], look))
    marks += [Level(bound, bound=True) for bound in (-QUANTILE, QUANTILE)]
    note = "dotted: 95 % lie inside if the filter knows its noise and that of the fixes"
    if any(np.any(np.abs(scaled) > REACH) for _, scaled in shown.residuals.values()):
        note += f"; not shown: beyond ±{REACH:g}"
    label = "later fix - estimate, x\n(standard deviations)"
    return Panel(label, marks, shown.view, (-REACH, REACH), note)


def _explain(session: Session, quantity: str, shown: Traces) -> Iterator[str]:
    if session.advised in shown.lines and len(shown.lines) > 1:
        yield f"Drawn on top: {session.advised}, the best scheme by the advice."
    left = [name for name in session.names if name not in shown.lines]
    if quantity in ("position", "velocity") and left:
        yield f"{' and '.join(left)}: the same line as one that is drawn."
    if quantity == "position":
        delay = session.sensors.delay * session.sensors.step
        yield f"A fix tells the position of {delay:g} s before it arrives."
        if shown.residuals:
            yield "Below: the fix that tells of a moment later, minus the estimate of that moment."
        if session.record.gnss == "from_reference":
            yield "Fixes were made from the reference, with simulated noise; the IMU is recorded."
        elif session.record.gnss == "simulated":
            yield "Fixes and IMU are simulated from the recorded motion (replicate 0)."
        if np.any(session.record.origin != 0.0):
            x, y = session.record.origin
            yield f"The mean position ({x:.3g}, {y:.3g}) m is taken off."
    if quantity in ("acceleration", "bias"):
        yield "Estimates are drawn at the time to which they refer, not when the filter gives them."
    if quantity != "bias":
        return
    if session.record.steps > POINTS:
        every = 2.0 * session.record.steps / POINTS * session.record.step
        yield f"Drawn are the least and the greatest value of every {every:.3g} s."
    limits = [_find_limits(shown, axis) for axis in range(2)]
    pairs = shown.lines.values()
    if any(leaves(pair[axis], *limits[axis]) for pair in pairs for axis in range(2)):
        yield (
            "Panels of x and y are scaled to the values after the first fifth of the record;"
            " before, lines leave them."
        )
    if shown.truth is None:
        yield "It holds whatever the IMU reports besides motion: leaks of gravity too."
