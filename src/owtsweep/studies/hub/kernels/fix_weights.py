"""Weighs position fixes by their distance from a prediction: a gate, or Huber's rule.

`hub.fix_rules` says what the rules mean.
"""

from __future__ import annotations

import numpy as np

from owtsweep.compiled import njit
from owtsweep.studies.hub.kernels.online_layout import BEYOND, GATE, LEAST_CHANGE


@njit
def distance(fix, state, variance):
    """Return the distance of a fix (2,) from a state's position, in standard deviations.

    The state has the shape (states, 2), positions first; `variance`, m^2, is that of the difference
    along each axis.
    """
    x, y = fix[0] - state[0, 0], fix[1] - state[0, 1]
    return np.sqrt((x * x + y * y) / variance)


@njit
def judge(far, settings, counter):
    """Return the weight, from 0 to 1, of a new fix that is `far` standard deviations away.

    `settings` are `FilterSettings`. `counter[BEYOND]`, of `OnlineRegisters`, counts the fixes in a
    row beyond the limit.
    """
    if far <= settings.fix_limit:
        counter[BEYOND] = 0
        return 1.0
    counter[BEYOND] += 1
    if settings.fix_rule == GATE:
        return 0.0 if counter[BEYOND] <= settings.fix_patience else 1.0
    return settings.fix_limit / far


@njit
def weigh_anew(n, h, m):
    """Weigh the fixes of the MHE's window by their distances from its nodes; tell of changes.

    The MHE is the moving horizon estimator. The window has n links; h and m are `HorizonSettings`
    and `OnlineRegisters`. The square roots of the weights go to m.weight. Return whether a weight
    changed by more than `LEAST_CHANGE`.
    """
    variance = 1.0 / (h.inverse_sigma * h.inverse_sigma)
    changed = 0.0
    for i in range(n + 1):
        if m.have[i]:
            far = distance(m.z[i], m.nodes[i], variance)
            weight = 1.0 if far <= h.fix_limit else h.fix_limit / far
            changed = max(changed, abs(weight - m.weight[i] * m.weight[i]))
            m.weight[i] = np.sqrt(weight)
    return changed >= LEAST_CHANGE
