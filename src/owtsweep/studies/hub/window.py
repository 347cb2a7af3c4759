"""Solves one window of the MHE by CasADi, with constraints if there are any.

Both forms of HME2 use it: the one in Python and the compiled one.
"""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.estimation.casadi_window import CasadiWindow
from owtsweep.estimation.mhe import square_root_information
from owtsweep.studies.hub.contract import Sensors
from owtsweep.studies.hub.horizon import Horizon, transition_over

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
    filled: bool,
    x0: Array,
    covariance: Array | None,
) -> Array:
    """Solve a window of the MHE; return the states of its nodes, one column per node, (6, nodes).

    The states are x, y, v_x, v_y, b_x, b_y: position, velocity and bias.

    Parameters
    ----------
    since_fix
        Number of steps since the last node at a fix. If positive, the present is one more node.
    fixes, have
        Position fixes in m, shape (fix nodes, 2), and whether each has arrived, (fix nodes,).
    effects
        Effects of the inputs on the state between two nodes, shape (links, 6). If `since_fix` is
        positive, the last link ends at the present.
    filled
        Whether the arrival state comes from the filter's past and so includes the oldest fix.
    x0, covariance
        Arrival state (6,) and its covariance (3, 3) along one axis; None if there is no arrival
        term.

    Raises
    ------
    ArithmeticError
        If the solver's answer does not meet the conditions of optimality.
    """
    fixed = mhe.fixed and filled
    rows, lower, upper = constraint_rows(mhe.bounds, sensors)
    problem = _problem(
        len(fixes) - 1,
        last_node=since_fix > 0,
        arrival=covariance is not None and not fixed,
        fixed_arrival=fixed,
        use_first_fix=not filled,
        solver=solver,
        constraints=len(rows),
    )
    prior: Array = np.eye(6)
    if covariance is not None:
        prior = np.kron(square_root_information(covariance), _I)
    weights = mhe.weights
    deviation = np.sqrt(np.diagonal(weights.link_covariance))
    scale = np.kron([np.sqrt(weights.fix_variance), deviation[1], deviation[2]], [1.0, 1.0])
    return problem.solve(
        scale=scale,
        z=np.where(have[:, None], fixes, 0.0).T,
        inputs=effects.reshape(-1, 6).T,
        A=np.kron(weights.transition, _I),
        A_f=np.kron(transition_over(since_fix * sensors.step), _I),
        link=np.kron(square_root_information(weights.link_covariance), _I),
        fix=np.where(have, 1.0 / np.sqrt(weights.fix_variance), 0.0),
        x0=x0,
        prior=prior,
        rows=rows,
        lower=lower,
        upper=upper,
    )


def constraint_rows(bounds: Array, sensors: Sensors) -> tuple[Array, Array, Array]:
    """Return the constraints lower <= rows x <= upper on the state x (6,) of a node.

    The result is rows (count, 6), lower (count,) and upper (count,). `bounds` are the largest
    magnitudes of position, velocity and bias; only finite bounds give rows. The bias is bounded in
    the IMU's frame: b^b = R' g - R' x4 by Eq. (6) of Ren et al. (2019).
    """
    rows, shift = np.kron(np.eye(3), _I), np.zeros(6)
    rows[4:, 4:] = -sensors.rotation.T
    shift[4:] = sensors.rotation.T @ np.array(sensors.gravity)
    limit = np.repeat(bounds, 2)
    there = np.isfinite(limit)
    return rows[there], (-limit - shift)[there], (limit - shift)[there]


@lru_cache(maxsize=256)
def _problem(intervals: int, **kind: Any) -> CasadiWindow:
    """Return the optimisation problem of a window; it holds no data, so all estimators share it."""
    return CasadiWindow(intervals, states=6, outputs=2, **kind)
