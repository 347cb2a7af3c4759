"""Panels of errors over time: the errors of one axis, or the accumulated errors of all axes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.figures.lines import clip, make_line
from owtsweep.figures.time_histories import UNITS, Curve, Level, Panel, show_estimate

#: Times (n,) in s, and the errors at them, (n, axes).
Errors = tuple[Array, Array]


def show_errors(
    errors: Mapping[str, Errors],
    names: Sequence[str],
    quantity: str,
    view: tuple[float, float],
    *,
    bound: float | None = None,
    note: str = "",
) -> Panel:
    """A panel with the errors of x during a view (a span of time).

    Parameters
    ----------
    errors
        Scheme -> its errors.
    names
        All schemes of the study, which determine the looks.
    quantity
        One of `UNITS`.
    view
        First and last time shown, s.
    bound
        A bound on the error, marked on both sides of zero.
    """
    marks: list[Curve | Level] = [
        show_estimate(name, names, make_line(*clip(time, error[:, 0], view)))
        for name, (time, error) in errors.items()
    ]
    if bound is not None:
        marks += [Level(-bound, bound=True), Level(bound, bound=True)]
    return Panel(f"error of x ({UNITS[quantity]})", [*marks, Level(0.0)], view, note=note)


def show_accumulated(
    errors: Mapping[str, Errors], names: Sequence[str], quantity: str, end: float
) -> Panel:
    """A panel with the absolute error of all axes, integrated over time from the record's start.

    Parameters
    ----------
    errors
        Scheme -> its errors over the whole record, in equal steps from 0 s.
    names
        All schemes of the study, which determine the looks.
    quantity
        One of `UNITS`.
    end
        End of the record, s.
    """
    marks, ends = [], []
    for name, (time, error) in errors.items():
        total = float(time[1]) * np.cumsum(np.sum(np.abs(error), axis=1))
        marks.append(show_estimate(name, names, make_line(time, total)))
        ends.append(f"{name} {total[-1]:.3g}")
    unit = {"m": "m s", "m/s": "m", "m/s²": "m/s"}[UNITS[quantity]]
    return Panel(
        label=f"accumulated |error|,\nx + y ({unit})",
        marks=marks,
        view=(0.0, end),
        limits=(0.0, None),
        note=f"over the whole record; at its end: {', '.join(ends)}",
    )
