"""Figures 9-14 of Ren et al. (2019): one record over time, and its accumulated errors."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.figures import time_histories
from owtsweep.figures.error_panels import show_accumulated, show_errors
from owtsweep.figures.lines import Line, clip, make_line
from owtsweep.figures.time_histories import UNITS, Curve, Panel
from owtsweep.studies.hub.histories import Histories

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: The schemes of the paper's figures; if the run has none of them, all its schemes are drawn.
SHOWN = ("MKF", "HME1", "HME2")
#: Seconds of the record that the histories show: from its start, and in the zoom.
SPAN = 120.0
ZOOM = 15.0
#: Seconds shown of the acceleration, whose noise would hide everything else in a longer view.
ACCELERATION_ZOOM = 6.0
AXES = ("x", "y")
ALONE: dict[str, Any] = {
    "color": "#D55E00", "linewidth": 1.1, "linestyle": (0, (1, 1)), "zorder": 1.9,
    "label": "IMU alone,\nintegrated",
}  # fmt: skip
#: Height of a panel that shows the drift of the integrated IMU, in amplitudes of the motion.
VIEW = 1.6
#: The bound of the velocity error in section 5.2, m/s.
VELOCITY_BOUND = 0.05

#: First and last time that a panel shows, s.
View = tuple[float, float]


def draw(
    histories: Histories,
    quantity: str,
    *,
    zoom: bool = False,
    tuning: str,
    schemes: Sequence[str] | None = None,
) -> Figure:
    """Draw one quantity over time, x above y, and the accumulated errors below them.

    Parameters
    ----------
    histories
        The result of `owtsweep.studies.hub.histories.simulate_histories`.
    quantity
        "position", "velocity", "acceleration" or "bias".
    zoom
        Show `ZOOM` s of the settled part, and the errors of x there in the lowest panel.
    tuning
        Named in the title.
    schemes
        The schemes to draw. By default those of `SHOWN` that the histories hold, or else all.

    Raises
    ------
    InputError
        If there is no such quantity or no scheme to draw.
    """
    if quantity not in UNITS:
        raise InputError(f"quantity: {quantity!r} is none of {', '.join(UNITS)}")
    names = _names(histories, quantity, schemes)
    view = _view(histories, quantity, zoom=zoom)
    panels = [_values(histories, quantity, axis, names, view) for axis in range(2)]
    return time_histories.draw(
        [*panels, _errors(histories, quantity, names, view if zoom else None)],
        title=f"{time_histories.describe(quantity)} estimate{', zoomed in' if zoom else ''}, "
        f"natural period {histories.natural_period:g} s, amplitude {histories.amplitude:g} m, "
        f"tuning: {tuning}",
        footnote=_explanations(histories, quantity, names),
    )


def _names(histories: Histories, quantity: str, schemes: Sequence[str] | None) -> list[str]:
    if schemes is None:
        of_the_paper = [name for name in histories.estimated if name in SHOWN]
        schemes = of_the_paper or list(histories.estimated)
    for name in schemes:
        if name not in histories.estimated:
            have = ", ".join(histories.estimated) or "none"
            raise InputError(f"schemes: {name!r} was not run on this record; it has {have}")
    if quantity == "acceleration":
        schemes = [n for n in schemes if histories.estimated[n].acceleration is not None]
    if not schemes:
        raise InputError(f"schemes: none of this run estimates the {quantity}")
    return list(schemes)


def _view(histories: Histories, quantity: str, *, zoom: bool) -> View:
    whole = float(histories.time[-1])
    if zoom or quantity == "acceleration":
        length = ACCELERATION_ZOOM if quantity == "acceleration" else ZOOM
        start = max(min(SPAN, whole) - length, 0.0)
        return start, min(start + length, whole)
    return 0.0, whole if quantity == "bias" else min(SPAN, whole)


def _estimate(histories: Histories, name: str, quantity: str) -> tuple[Array, Array]:
    """Times (n,) and values (n, 2) of an estimate, each at the time to which it refers."""
    estimated = histories.estimated[name]
    values = getattr(estimated, quantity)
    if quantity in ("position", "velocity"):
        return histories.time, values
    return histories.time[: len(values) - estimated.lag], values[estimated.lag :]


def _values(
    histories: Histories, quantity: str, axis: int, names: Sequence[str], view: View
) -> Panel:
    """The panel of x or y: truth, measurements and estimates."""

    def inside(values: Array) -> Line:
        return make_line(*clip(histories.time, values[:, axis], view))

    marks: list[Curve] = []
    if quantity == "acceleration":
        marks.append(time_histories.show_measurement(inside(histories.measured)))
    marks.append(time_histories.show_truth(inside(getattr(histories, quantity))))
    if _drift_in_view(histories, quantity, axis, view):
        marks.append(Curve(inside(_integrated(histories, quantity)), ALONE))
    if quantity == "position":
        fixes = clip(histories.fix_time, histories.fixes[:, axis], view)
        marks.append(
            time_histories.show_fixes(*fixes, label="GNSS fixes\n(as they arrive)", size=7)
        )
    for name in names:
        time, estimated = _estimate(histories, name, quantity)
        line = make_line(*clip(time, estimated[:, axis], view))
        marks.append(time_histories.show_estimate(name, list(histories.estimated), line))
    return Panel(
        label=f"{AXES[axis]} {quantity} ({UNITS[quantity]})",
        marks=marks,
        view=view,
        limits=_limits(histories, quantity, axis, names, view),
        note=_drift_note(histories, quantity, axis, view),
        note_color=ALONE["color"],
    )


def _limits(
    histories: Histories, quantity: str, axis: int, names: Sequence[str], view: View
) -> tuple[float | None, float | None]:
    """The limits of the axis: for a bias without its start, otherwise without the IMU's drift."""
    if quantity == "bias":
        settled = len(histories.time) // 10  # the start would hide everything after it
        estimates = [_estimate(histories, name, quantity)[1][settled:, axis] for name in names]
        values = np.concatenate([histories.bias[:, axis], *estimates])
        margin = 0.3 * np.ptp(values)
        return values.min() - margin, values.max() + margin
    if _drift_in_view(histories, quantity, axis, view):
        limit = _reach(histories, quantity, axis)
        return -limit, limit
    return None, None


def _integrated(histories: Histories, quantity: str) -> Array:
    """(steps, 2) position or velocity from integrating the IMU alone."""
    return np.asarray(getattr(histories, f"integrated_{quantity}"))


def _reach(histories: Histories, quantity: str, axis: int) -> float:
    """The largest absolute value on the axis of a panel that shows the IMU's drift."""
    return VIEW * float(np.max(np.abs(getattr(histories, quantity)[:, axis])))


def _drift_in_view(histories: Histories, quantity: str, axis: int, view: View) -> bool:
    """Whether the integrated IMU is within the panel at some time of the view."""
    if quantity not in ("position", "velocity"):
        return False
    _, alone = clip(histories.time, _integrated(histories, quantity)[:, axis], view)
    return bool(np.min(np.abs(alone)) <= _reach(histories, quantity, axis))


def _drift_note(histories: Histories, quantity: str, axis: int, view: View) -> str:
    """A note on when the drift of the integrated IMU leaves the panel; empty if it does not."""
    if quantity not in ("position", "velocity"):
        return ""
    alone = _integrated(histories, quantity)[:, axis]
    limit, unit = _reach(histories, quantity, axis), UNITS[quantity]
    last = int(np.searchsorted(histories.time, view[1], side="right")) - 1
    outside = np.abs(alone) > limit
    if not outside[last]:
        return ""
    return (
        f"IMU alone, integrated: leaves ±{limit:.2g} {unit} after "
        f"{histories.time[int(np.argmax(outside))]:.0f} s, is at {alone[last]:.3g} {unit} after "
        f"{histories.time[last]:.0f} s"
    )


def _errors(histories: Histories, quantity: str, names: Sequence[str], view: View | None) -> Panel:
    """The errors of x in a view, or the accumulated errors of x and y over the record."""
    truth = getattr(histories, quantity)
    estimates = {name: _estimate(histories, name, quantity) for name in names}
    errors = {name: (time, values - truth[: len(values)])
              for name, (time, values) in estimates.items()}  # fmt: skip
    schemes = list(histories.estimated)
    if view is None:
        return show_accumulated(errors, schemes, quantity, float(histories.time[-1]))
    if quantity != "velocity":
        return show_errors(errors, schemes, quantity, view)
    note = f"dotted: ±{VELOCITY_BOUND:g} m/s of section 5.2"
    return show_errors(errors, schemes, quantity, view, bound=VELOCITY_BOUND, note=note)


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
        sentences += _lags(histories, names)
    if quantity == "bias":
        sentences.append("Panels of x and y are scaled to what is left after the transient.")
    if quantity in ("acceleration", "bias") and len(names) > 1:
        sentences.append("Where one line shows, the others lie under it.")
    sentences += [f"{name} is left out: {why}." for name, why in histories.left_out.items()]
    return " ".join(sentences)


def _lags(histories: Histories, names: Sequence[str]) -> list[str]:
    """A note on the delay with which each scheme's filter estimates its states."""
    lags: dict[float, list[str]] = {}
    for name in names:
        lag = histories.estimated[name].lag * float(histories.time[1])
        lags.setdefault(round(lag, 9), []).append(name)
    when = "; ".join(
        f"{' and '.join(group)} {f'{lag:g} s later' if lag else 'at once'}"
        for lag, group in sorted(lags.items())
    )
    sentences = [
        f"Each value of the filter stands at the moment that it is about; it is known: {when}."
    ]
    if 0.0 in lags:
        sentences.append(
            "A filter without delay mixes fixes of the past with an IMU of the present."
        )
    return sentences
