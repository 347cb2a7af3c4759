"""Complementary filters: low frequencies from a position, high ones from its derivatives.

`blend_fixes` is that of inertial navigation with fixed gains. Gyroscopes turn the attitude, which
the accelerometers level slowly (Mahony, Hamel and Pflimlin 2008, Nonlinear complementary filters on
the special orthogonal group); the heading is that of the start and the gyroscopes. Levelled
accelerations move position and velocity, which fixes correct.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.estimation.inertial.attitude import rotate
from owtsweep.estimation.inertial.strapdown import GYROSCOPES, move, place


def place_poles(crossover: float, step: float) -> tuple[float, float]:
    """Return the gains of position and velocity: poles of s^2 + sqrt(2) w s + w^2, sampled.

    `crossover` is w in rad/s, at which both parts count alike; `step` is in s.
    """
    turn = crossover * step / np.sqrt(2.0)
    radius = np.exp(-turn)
    return 1.0 - radius**2, (1.0 + radius**2 - 2.0 * radius * np.cos(turn)) / step


@njit
def blend_acceleration(position, acceleration, step, gains, start, estimate):
    """Blend positions, NaN where there is none, with an acceleration, shape (steps,) each.

    step: sampling interval in s.
    gains: as `place_poles` returns them.
    start: position at the first sample; the velocity is 0 there.
    estimate: position and velocity of each sample, its report counted, shape (steps, 2);
        overwritten.
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
    """Blend positions with a rate, which is the velocity; arguments as of `blend_acceleration`."""
    x = start
    for k in range(len(position)):
        if k > 0:
            x += 0.5 * step * (rate[k - 1] + rate[k])
        e = position[k] - x
        if not np.isnan(e):
            x += gain * e
        estimate[k, 0], estimate[k, 1] = x, rate[k]


@njit
def blend_fixes(record, gains, s, states):
    """Filter a `strapdown.Record` by the fixes of the first antenna.

    gains: of position and velocity per fix, and of the levelling per second.
    s: the start, shape (16,); overwritten.
    states: filled, shape (steps, 16).
    """
    fixes, levers, _, due, force, rate, step, _ = record
    R, new, at = np.empty((3, 3)), np.empty((3, 3)), np.empty(3)
    alpha, beta, level = gains
    for k in range(len(force)):
        if k > 0:
            rotate(s[6:10], R)
            # what a body at rest would feel is g R' e_z: turn the body until it does
            f = force[k - 1]
            slow = -level / np.sqrt(f[0] ** 2 + f[1] ** 2 + f[2] ** 2)
            s[13] = slow * (f[1] * R[2, 2] - f[2] * R[2, 1])
            s[14] = slow * (f[2] * R[2, 0] - f[0] * R[2, 2])
            s[15] = slow * (f[0] * R[2, 1] - f[1] * R[2, 0])
            mean = 0.5 * (rate[k - 1] + rate[k])
            move(s, step, f, force[k], mean, GYROSCOPES, R, new)
        if due[k] and not np.isnan(fixes[k, 0, 0]):
            rotate(s[6:10], R)
            place(s, R, levers[0], at)
            for i in range(3):
                s[i] += alpha * (fixes[k, 0, i] - at[i])
                s[3 + i] += beta * (fixes[k, 0, i] - at[i])
        s[13:16] = 0.0  # what levels is no bias
        states[k] = s
