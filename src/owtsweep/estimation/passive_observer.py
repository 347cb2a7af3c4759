"""Fossen's non-linear passive observer of position and velocity, on measured positions alone.

Fossen (2011), Handbook of Marine Craft Hydrodynamics and Motion Control, section 11.4, for each
degree of freedom i, with the innovation e = y - eta - xi_2:

    xi_1' = xi_2 + k_11 e
    xi_2' = -w0^2 xi_1 - 2 lambda w0 xi_2 + k_12 e      waves
    eta'  = R(psi) nu + k_2 e                           slow position
    b'    = k_3 e                                       bias: mean loads
    nu'   = -2 zeta wn nu - wn^2 R' eta + R' b + R' k_4 e

R turns surge and sway by the measured yaw. What differs from the book:

- Mass is 1: wn and zeta stand for stiffness and damping over mass. The stiffness is that of moored
  vessels (Strand and Fossen 1999); thrust is unknown, so there is none.
- The bias does not fade (1 / T = 0, a Wiener process). With a finite T a mean position never
  settles: e stays at a part of it, and k_2 e is missing in the velocity.
- There the waves are taken away before the position goes to a vessel's control. A hybrid test needs
  all of the motion, so the position is eta + xi_2 and the velocity R nu + xi_2', each as its model
  has it, without e.
- k_3 and k_4, which are tuned by hand there, follow from frequencies (`choose_gains`).
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.compiled import njit

#: Damping of the waves' model, and of the notch in the observer's error (Fossen 2011, 11.4).
LAMBDA, NOTCH = 0.1, 1.0


def choose_gains(natural: Array, waves: Array, cutoff: Array) -> Array:
    """Return k_11, k_12, k_2, k_3, k_4 of each degree of freedom, shape (5, n).

    natural, waves, cutoff: frequencies wn, w0 and wc in rad/s, shape (n,). wc, from which the slow
        part does not follow, is to be above w0.

    k_11 = -2 (1 - lambda) wc / w0, k_12 = 2 w0 (1 - lambda), k_2 = wc
    (Fossen 2011, Eqs. 11.100 to 11.102). k_4 = wc^2 / 2 damps the slow position's error by
    1 / sqrt(2) of critical. k_3 = k_4 wn / 10 keeps the order k_3/k_4 < w0 < wc that makes the
    observer passive; Fossen's own example has k_3 = k_4 / 10 at w0 = .9 rad/s (MSS toolbox,
    ExPassiveObs.m, which has the same k_1 and k_2).
    """
    k4 = 0.5 * cutoff**2
    return np.stack(
        [
            -2.0 * (NOTCH - LAMBDA) * cutoff / waves,
            2.0 * waves * (NOTCH - LAMBDA),
            cutoff,
            0.1 * natural * k4,
            k4,
        ]
    )


def find_growth(natural: float, damping: float, waves: float, gains: Array, step: float) -> float:
    """Return the factor by which the error of one degree of freedom grows per step in `observe`.

    Explicit steps may be unstable where the observer is not: the factor is to be below 1. `gains`
    has the shape (5,); `step` is the sampling interval in s.
    """
    k11, k12, k2, k3, k4 = gains
    e = np.array([0.0, -1.0, -1.0, 0.0, 0.0])  # xi_1, xi_2, eta, b, nu
    xi1, xi2, eta, b, nu = np.eye(5)
    after = xi1 + step * (xi2 + k11 * e)
    matrix = np.stack(
        [
            after,
            xi2 + step * (-(waves**2) * after - 2.0 * LAMBDA * waves * xi2 + k12 * e),
            eta + step * (nu + k2 * e),
            b + step * k3 * e,
            nu + step * (b - natural**2 * eta - 2.0 * damping * natural * nu + k4 * e),
        ]
    )
    return float(np.abs(np.linalg.eigvals(matrix)).max())


@njit
def observe(reported, step, natural, damping, waves, gains, start, found):
    """Run the observer over a record of six degrees of freedom.

    reported: positions and angles, shape (steps, 6); a sample that is NaN has no report.
    step: sampling interval in s.
    natural, damping, waves: natural frequencies (rad/s), damping ratios and wave frequencies
        (rad/s), shape (6,).
    gains: as `choose_gains` returns them, shape (5, 6).
    start: positions at the first sample, shape (6,).
    found: positions and velocities, shape (steps, 6) each; overwritten. Those of a sample know the
        reports before it.
    """
    position, velocity = found
    xi1, xi2, eta, nu = np.zeros(6), np.zeros(6), start.copy(), np.zeros(6)
    bias = natural * natural * start
    e, push, speed = np.zeros(6), np.zeros(6), np.zeros(6)
    yaw = start[5]
    for k in range(len(reported)):
        c, s = np.cos(yaw), np.sin(yaw)
        speed[:] = nu
        speed[0], speed[1] = c * nu[0] - s * nu[1], s * nu[0] + c * nu[1]
        for i in range(6):
            position[k, i] = eta[i] + xi2[i]
            rise = -waves[i] * waves[i] * xi1[i] - 2.0 * LAMBDA * waves[i] * xi2[i]
            velocity[k, i] = speed[i] + rise
            e[i] = reported[k, i] - position[k, i]
            if np.isnan(e[i]):
                e[i] = 0.0
            push[i] = bias[i] - natural[i] * natural[i] * eta[i] + gains[4, i] * e[i]
        if not np.isnan(reported[k, 5]):
            yaw = reported[k, 5]
        push[0], push[1] = c * push[0] + s * push[1], -s * push[0] + c * push[1]
        for i in range(6):
            # The waves' oscillator takes its new displacement: so a step keeps its energy.
            xi1[i] += step * (xi2[i] + gains[0, i] * e[i])
            push_waves = -waves[i] * waves[i] * xi1[i] - 2.0 * LAMBDA * waves[i] * xi2[i]
            xi2[i] += step * (push_waves + gains[1, i] * e[i])
            nu[i] += step * (push[i] - 2.0 * damping[i] * natural[i] * nu[i])
            eta[i] += step * (speed[i] + gains[2, i] * e[i])
            bias[i] += step * gains[3, i] * e[i]
