"""Solves one window of HME2's MHE by CasADi, with constraints if any.

HME2 in Python and the compiled HME2 both use this module.
"""

from __future__ import annotations

from functools import lru_cache, partial
from typing import Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.estimation.casadi_window import CasadiWindow
from owtsweep.estimation.mhe import square_root_information
from owtsweep.studies.hub.horizon import Horizon, transition_over
from owtsweep.studies.hub.kernels.online_layout import LEAST_CHANGE, MOST_WEIGHINGS
from owtsweep.studies.hub.sensors import Sensors

_I = np.eye(2)


def solve(
    mhe: Horizon,
    sensors: Sensors,
    *,
    solver: str,
    since_fix: int,
    fixes: Array,
    have: NDArray[np.bool_],
    effects: Array,
    past: tuple[Array, Array] | None,
) -> Array:
    """Solve a window of the MHE; return the states at the window's nodes, shape (6, nodes).

    The states are x, y, v_x, v_y, b_x, b_y: position, velocity and bias. A node is a step at which
    a fix is due; the present may be one more, the last.

    solver: the solver that CasADi uses: "qrqp" or "ipopt".
    since_fix: number of IMU steps since the last fix was due. If positive, the present is one more
        node.
    fixes, have: position fixes in m, shape (n, 2), and whether each has arrived, shape (n,).
    effects: effects of the inputs on the state from each node to the next, shape (nodes - 1, 6).
    past: the filter's past state (6,) at the oldest node, and its covariance (3, 3) along one axis.
        They include the oldest fix, so the fix is not used again. None while the window fills.
    Raises ArithmeticError if the solver's answer does not meet the conditions of optimality.
    """
    fixed = mhe.fixed and past is not None
    x0, covariance = (np.zeros(6), mhe.initial_covariance) if past is None else past
    rows, lower, upper = constraint_rows(mhe.bounds, sensors)
    problem = _problem(
        len(fixes) - 1,
        last_node=since_fix > 0,
        arrival=mhe.arrival and not fixed,
        fixed_arrival=fixed,
        use_first_fix=past is None,
        solver=solver,
        constraints=len(rows),
    )
    weights = mhe.weights
    deviation = np.sqrt(np.diagonal(weights.link_covariance))
    scale = np.kron([np.sqrt(weights.fix_variance), deviation[1], deviation[2]], [1.0, 1.0])
    solve_weighted = partial(
        problem.solve,
        scale,
        np.where(have[:, None], fixes, 0.0).T,
        effects.reshape(-1, 6).T,
        A=np.kron(weights.transition, _I),
        A_f=np.kron(transition_over(since_fix * sensors.step, mhe.lean), _I),
        link=np.kron(square_root_information(weights.link_covariance), _I),
        x0=x0,
        prior=np.kron(square_root_information(covariance), _I),
        rows=rows,
        lower=lower,
        upper=upper,
    )
    plain = np.where(have, 1.0 / np.sqrt(weights.fix_variance), 0.0)
    nodes = solve_weighted(fix=plain)
    if not mhe.fix_rule.fades:
        return nodes
    # Huber's cost by weighted least squares, each solved with the weights of the one before: the
    # cost never rises, with constraints neither (Huber 1981, section 7.8)
    weight: Array = np.ones(len(fixes))
    limit = mhe.fix_rule.limit
    for _ in range(MOST_WEIGHINGS):
        distances = plain * np.linalg.norm(fixes - nodes[:2, : len(fixes)].T, axis=1)
        before, weight = weight, limit / np.maximum(distances, limit)
        if np.max(np.abs(weight - before)) < LEAST_CHANGE:
            break
        nodes = solve_weighted(fix=np.sqrt(weight) * plain)
    return nodes


def constraint_rows(bounds: Array, sensors: Sensors) -> tuple[Array, Array, Array]:
    """Return the constraints on one state x (6,) of the MHE as lower <= rows x <= upper.

    The result is rows (n, 6), lower (n,) and upper (n,). `bounds` (3,) are the largest magnitudes
    of position, velocity and bias; only finite bounds give constraints. The bias is bounded in the
    IMU's frame: b^b = R' g - R' x4 by Eq. (6) of Ren et al. (2019).
    """
    rows, shift = np.kron(np.eye(3), _I), np.zeros(6)
    rows[4:, 4:] = -sensors.rotation.T
    shift[4:] = sensors.rotation.T @ np.array(sensors.gravity)
    limit = np.repeat(bounds, 2)
    there = np.isfinite(limit)
    return rows[there], (-limit - shift)[there], (limit - shift)[there]


@lru_cache(maxsize=256)
def _problem(intervals: int, **kind: Any) -> CasadiWindow:
    """Return the problem of a window over some GNSS intervals; without data, so all share it."""
    return CasadiWindow(intervals, states=6, outputs=2, **kind)
