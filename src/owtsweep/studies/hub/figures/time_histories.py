"""Draws a record over time and the schemes' errors, like figures 9-14 of Ren et al. (2019)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.figure import Figure

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.figures import style, time_histories
from owtsweep.figures.lines import Line, clip, make_line
from owtsweep.figures.time_histories import UNITS, Curve, Panel, show_accumulated, show_errors
from owtsweep.studies.hub.histories import Histories

#: The schemes of the paper's figures; if the run has none of them, all its schemes are drawn.
SHOWN = ("MKF", "HME1", "HME2")
#: Seconds of the record shown: from its start (`SPAN`), and in the zoomed figures (`ZOOM`).
SPAN = 120.0
ZOOM = 15.0
#: Seconds shown of the acceleration, whose noise would hide everything else in a longer view.
ACCELERATION_ZOOM = 6.0
AXES = ("x", "y")
ALONE: style.Look = {
    "color": "#D55E00", "linewidth": 1.1, "linestyle": (0, (1, 1)), "zorder": 1.9,
    "label": "IMU alone,\nintegrated",
}  # fmt: skip
#: Height of a panel that shows the drift of the integrated IMU, in amplitudes of the motion.
VIEW = 1.6
#: The bound on the velocity error in the paper's section 5.2, m/s.
VELOCITY_BOUND = 0.05

#: First and last time that a panel shows, s.
View = tuple[float, float]
#: Limits of a panel's vertical axis; None for a limit that follows from the values.
Limits = tuple[float | None, float | None]


def draw(histories: Histories, quantity: str, *, zoom: bool = False, tuning: str) -> Figure:
    """Draw one quantity over time: a panel for x, a panel for y, and a panel of errors below.

    The lowest panel shows the accumulated errors of x and y, or in a zoomed figure the errors of x.
    Drawn are MKF, HME1 and HME2, or all schemes if the histories have none of these three.

    quantity: "position", "velocity", "acceleration" or "bias".
    zoom: whether to show only `ZOOM` s, or `ACCELERATION_ZOOM` s of acceleration. They end `SPAN` s
        after the record's start, or at the record's end if that is earlier.
    tuning: name of the tuning, for the title.
    Raises InputError if none of the schemes estimates the quantity.
    """
    estimates = _choose(histories, quantity)
    view = _view(histories, quantity, zoom=zoom)
    panels = [_values(histories, quantity, axis, estimates, view) for axis in range(2)]
    return time_histories.draw(
        [*panels, _errors(histories, quantity, estimates, view if zoom else None)],
        title=f"{time_histories.describe(quantity)} estimate{_name_part(histories, view)}"
        f"{_describe_motion(histories, tuning)}",
        footnote=_explanations(histories, quantity, list(estimates)),
    )


def _describe_motion(histories: Histories, tuning: str) -> str:
    period, amplitude = histories.natural_period, histories.amplitude
    if not histories.sea:
        return f"\nnatural period {period:g} s, amplitude {amplitude:g} m, tuning: {tuning}"
    return (
        f", tuning: {tuning}\n{histories.sea}: natural period {period:.2f} s, largest displacement "
        f"{amplitude:.2f} m"
    )


def _choose(histories: Histories, quantity: str) -> dict[str, Array]:
    """Return scheme -> estimates (n, 2), from the record's start on, of those that are drawn."""
    estimated = {name: each.values for name, each in histories.estimated.items()}
    names = [name for name in estimated if name in SHOWN] or list(estimated)
    shown = {name: estimated[name][quantity] for name in names if quantity in estimated[name]}
    if not shown:
        wanted = " with the model sigma1" if quantity == "acceleration" else ""
        raise InputError(
            f"schemes: none of this run estimates the {quantity}; use MKF, HME1 or HME2{wanted}"
        )
    return shown


def _view(histories: Histories, quantity: str, *, zoom: bool) -> View:
    whole = float(histories.time[-1])
    if zoom or quantity == "acceleration":
        length = ACCELERATION_ZOOM if quantity == "acceleration" else ZOOM
        start = max(min(SPAN, whole) - length, 0.0)
        return start, min(start + length, whole)
    return 0.0, whole if quantity == "bias" else min(SPAN, whole)


def _name_part(histories: Histories, view: View) -> str:
    """Name the part of the record that the panels of x and y show; "" for the whole record."""
    if view[1] - view[0] >= float(histories.time[-1]):
        return ""
    length = histories.time[-1] + histories.time[1]
    return f", {view[0]:g} to {view[1]:g} s of {length:g} s"


def _values(
    histories: Histories, quantity: str, axis: int, estimates: Mapping[str, Array], view: View
) -> Panel:
    """Make the panel of x (axis 0) or y (axis 1): truth, measurements and estimates."""

    time, truth = histories.time, histories.truth[quantity]

    def inside(values: Array) -> Line:
        return make_line(*clip(time[: len(values)], values[:, axis], view))

    marks: list[Curve] = []
    limits: Limits = (None, None)
    note = ""
    if quantity == "acceleration":
        marks.append(time_histories.show_measurement(inside(histories.measured)))
    marks.append(time_histories.show_truth(inside(truth)))
    if quantity in ("position", "velocity"):
        drift, limits, note = _drift(histories, quantity, axis, view)
        marks += drift
    if quantity == "position":
        fixes = clip(histories.fix_time, histories.fixes[:, axis], view)
        label = "GNSS fixes\n(as they arrive)"
        marks.append(time_histories.show_fixes(*fixes, label=label, size=7))
    if quantity == "bias":
        settled = len(time) // 10  # the start would hide everything after it
        series = [truth, *(values[settled:] for values in estimates.values())]
        ends = np.concatenate(series)[:, axis]
        margin = 0.3 * np.ptp(ends)
        limits = ends.min() - margin, ends.max() + margin
    marks += [
        time_histories.show_estimate(name, list(histories.estimated), inside(values))
        for name, values in estimates.items()
    ]
    label = f"{AXES[axis]} {quantity} ({UNITS[quantity]})"
    return Panel(label, marks, view, limits, note, note_color=ALONE["color"])


def _drift(
    histories: Histories, quantity: str, axis: int, view: View
) -> tuple[list[Curve], Limits, str]:
    """Make the line of the IMU's integrated acceleration, and a note on the line's drift.

    Return the line, unless it lies outside the panel during the whole view; the limits of the
    vertical axis, None without the line; and the note, which says when the line leaves the panel.
    """
    time, truth = histories.time, histories.truth[quantity][:, axis]
    alone = histories.integrated[quantity][:, axis]
    reach = VIEW * float(np.max(np.abs(truth)))
    marks: list[Curve] = []
    limits: Limits = (None, None)
    seen = clip(time, alone, view)
    if np.min(np.abs(seen[1])) <= reach:
        marks, limits = [Curve(make_line(*seen), ALONE)], (-reach, reach)
    last = int(np.searchsorted(time, view[1], side="right")) - 1
    outside = np.abs(alone) > reach
    if not outside[last]:
        return marks, limits, ""
    unit, left = UNITS[quantity], time[int(np.argmax(outside))]
    note = (
        f"{'' if marks else 'Not shown: '}IMU alone, integrated: leaves ±{reach:.2g} {unit} after "
        f"{left:.0f} s, is at {alone[last]:.3g} {unit} after {time[last]:.0f} s"
    )
    return marks, limits, note


def _errors(
    histories: Histories, quantity: str, estimates: Mapping[str, Array], view: View | None
) -> Panel:
    """Make the panel of the errors of x in the `view`, or of accumulated errors without one."""
    time, truth = histories.time, histories.truth[quantity]
    errors = {
        name: (time[: len(values)], values - truth[: len(values)])
        for name, values in estimates.items()
    }
    schemes = list(histories.estimated)
    if view is None:
        return show_accumulated(errors, schemes, quantity, float(histories.time[-1]))
    if quantity != "velocity":
        return show_errors(errors, schemes, quantity, view)
    note = f"dotted: ±{VELOCITY_BOUND:g} m/s of section 5.2"
    return show_errors(errors, schemes, quantity, view, bound=VELOCITY_BOUND, note=note)


def _explanations(histories: Histories, quantity: str, names: Sequence[str]) -> str:
    moves = quantity in ("position", "velocity")
    others = [name for name in histories.estimated if name not in names]
    blind = [name for name in others if name in SHOWN]
    rest = " and ".join(name for name in others if name not in blind)
    said = [
        (
            not histories.sea,
            f"The paper does not give the amplitude of its histories; {histories.amplitude:g} m is "
            "our choice (its text has HME1 ahead of HME2 there, and at 4 s only above 0.3 m).",
        ),
        (histories.sea, "The displacement is along the waves; x is north, y east."),
        (
            quantity == "position",
            f"A fix tells the position of {histories.delay:g} s before it arrives.",
        ),
        (moves, "The IMU alone is integrated from the true initial state."),
        *((not moves, lag) for lag in _lags(histories, names)),
        (
            quantity == "bias",
            "Panels of x and y are scaled to what is left after the first tenth of the record; "
            "before, lines may leave them.",
        ),
        (not moves and len(names) > 1, "Where one line shows, the others lie under it."),
        *((True, f"{name} estimates no {quantity}.") for name in blind),
        (rest, f"Not drawn, as in the paper: {rest}."),
        *((True, f"{name} is left out: {why}.") for name, why in histories.left_out.items()),
    ]
    return " ".join(sentence for is_so, sentence in said if is_so)


def _lags(histories: Histories, names: Sequence[str]) -> list[str]:
    lags: dict[float, list[str]] = {}
    for name in names:
        lag = histories.estimated[name].lag * float(histories.time[1])
        lags.setdefault(round(lag, 9), []).append(name)
    when = "; ".join(
        f"{' and '.join(group)} {f'{lag:g} s later' if lag else 'at once'}"
        for lag, group in sorted(lags.items())
    )
    sentences = [
        "Estimates are drawn at the time to which they refer; the filters give them then, or later:"
        f" {when}."
    ]
    if 0.0 in lags:
        sentences.append(
            "A filter without delay mixes fixes of the past with an IMU of the present."
        )
    return sentences
