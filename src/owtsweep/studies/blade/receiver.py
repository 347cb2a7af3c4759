"""Errors of a GNSS receiver besides white noise: slow errors, float solutions, reflected signals.

All antennas of a record suffer them alike: they hear the same sky. The processes are usual models,
not measured ones; Maes et al. (2018) say nothing about errors but their size.
"""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.sensing.faults import draw_outliers
from owtsweep.sensing.noise import draw_gauss_markov

if TYPE_CHECKING:
    from owtsweep.studies.blade.sections import Receiver


def draw_errors(
    receiver: Receiver,
    draws: partial[np.random.Generator],
    count: int,
    interval: float,
    vertical: float,
) -> tuple[Array, NDArray[np.bool_]]:
    """Draw what is added to successive fixes, and which of them are float solutions.

    Parameters
    ----------
    receiver
        The section `sensors.receiver`.
    draws
        Function that returns a random stream, given its name.
    count, interval
        Number of fixes, lost ones among them, and the time between two in s.
    vertical
        Vertical over horizontal errors.

    Returns
    -------
    tuple
        Errors in m, shape (count, 3), and whether the solution is float, shape (count,).
    """
    errors = np.zeros((count, 3))
    floating = draw_states(receiver, draws("float"), count, interval)
    slow = partial(draw_gauss_markov, time=receiver.red_time, step=interval, axes=3)
    if receiver.red_sigma > 0.0:
        errors += slow(draws("red"), count, sigma=receiver.red_sigma)
    if floating.any():
        drawn = slow(draws("float_error"), count, sigma=receiver.float_sigma)
        errors += np.where(floating[:, None], drawn, 0.0)
    if receiver.jump_every is not None:
        errors += draw_outliers(
            draws("jumps"),
            draws("jump_offsets"),
            count,
            rate=min(receiver.jump_time / receiver.jump_every, 0.5),
            sigma=receiver.jump_sigma,
            length=max(round(receiver.jump_time / interval), 1),
            axes=3,
        )
    return errors * [1.0, 1.0, vertical], floating


def draw_states(
    receiver: Receiver, draw: np.random.Generator, count: int, interval: float
) -> NDArray[np.bool_]:
    """Return at which fixes the solution is float, shape (count,).

    A record begins with a fixed solution. The times that either state lasts are exponentially
    distributed.
    """
    floating = np.zeros(count, dtype=bool)
    if receiver.fixed_time is None:
        return floating
    time = draw.exponential(receiver.fixed_time)
    while time < count * interval:
        end = time + draw.exponential(receiver.float_time)
        floating[int(np.ceil(time / interval)) : int(np.ceil(end / interval))] = True
        time = end + draw.exponential(receiver.fixed_time)
    return floating
