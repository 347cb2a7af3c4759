"""Complementary filters: low frequencies from a position, high ones from its derivatives."""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit


def place_poles(crossover: float, step: float) -> tuple[float, float]:
    """Return the gains of position and velocity with a damping ratio of 1/sqrt(2).

    The poles of the filter are those of s^2 + sqrt(2) w s + w^2, sampled.

    Parameters
    ----------
    crossover
        The angular frequency w in rad/s, at which both parts count alike.
    step
        Sampling interval in s.
    """
    turn = crossover * step / np.sqrt(2.0)
    radius = np.exp(-turn)
    return 1.0 - radius**2, (1.0 + radius**2 - 2.0 * radius * np.cos(turn)) / step


@njit
def blend_acceleration(position, acceleration, step, gains, start, estimate):
    """Blend positions with an acceleration.

    Parameters
    ----------
    position, acceleration
        Reported positions, NaN where there is none, and accelerations, shape (steps,).
    step
        Sampling interval in s.
    gains
        As `place_poles` returns them.
    start
        Position at the first sample; the velocity is 0 there.
    estimate
        Position and velocity of each sample, its report counted, shape (steps, 2); overwritten.
    """
    x, v = start, 0.0
    alpha, beta = gains
    for k in range(len(position)):
        if k > 0:
            a, b = acceleration[k - 1], acceleration[k]
            x += step * v + step * step * (a / 3.0 + b / 6.0)
            v += 0.5 * step * (a + b)
        e = position[k] - x
        if not np.isnan(e):
            x += alpha * e
            v += beta * e
        estimate[k, 0], estimate[k, 1] = x, v


@njit
def blend_rate(position, rate, step, gain, start, estimate):
    """Blend positions with a rate; the velocity is the rate itself.

    Parameters are those of `blend_acceleration`; `gain` is that of the position.
    """
    x = start
    for k in range(len(position)):
        if k > 0:
            x += 0.5 * step * (rate[k - 1] + rate[k])
        e = position[k] - x
        if not np.isnan(e):
            x += gain * e
        estimate[k, 0], estimate[k, 1] = x, rate[k]
