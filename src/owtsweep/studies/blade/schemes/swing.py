"""The hook's swing as states of a filter: oscillators driven by white noise about a slow middle.

The middle has no velocity: the hook is at rest, or wanders by no more than gusts do.
"""

from __future__ import annotations

import numpy as np
from scipy.linalg import expm

from owtsweep.arrays import Array
from owtsweep.studies.blade.contract import Setting


def describe_swing(setting: Setting, s: Array, P: Array, at: int) -> tuple[Array, Array]:
    """Return transitions (3, 2, 2) and noise (3, 3, 3) of a sample; begin s and P, in place.

    Each direction is m'' = -w^2 m - 2 z w m' + noise, whose stationary variances are the square of
    the swing's size and w^2 times it. The middle wanders as gusts do at first, and begins anywhere
    within some sizes of where the point under the hook is given to be. `at` is the first of the
    swing's errors.
    """
    transitions, noises = np.zeros((3, 2, 2)), np.zeros((3, 3, 3))
    under_hook = setting.start[0][0] - setting.start[1] @ setting.geometry.unit
    for i in range(3):
        w, size = 2.0 * np.pi / setting.swing_period[i], setting.swing_sigma[i]
        rate = np.array([[0.0, 1.0], [-(w**2), -2.0 * setting.swing_damping[i] * w]])
        stationary = size**2 * np.diag([1.0, w**2])
        F = expm(rate * setting.step)
        transitions[i] = F
        noises[i, :2, :2] = stationary - F @ stationary @ F.T
        noises[i, 2, 2] = 2.0 * setting.gust_sigma[i] ** 2 * setting.step / setting.gust_time
        for j, variance in ((0, size**2), (3, (w * size) ** 2), (6, (3.0 * size) ** 2)):
            P[at + j + i, at + j + i] = variance
        s[at + 7 + i] = under_hook[i]
    return transitions, noises
