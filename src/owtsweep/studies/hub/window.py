"""One window of the MHE as CasADi's problem, with its constraints, for both forms of HME2."""

from __future__ import annotations

from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.estimation.mhe import CasadiWindow, square_root_information
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
    """The states of a window's nodes, (6, nodes): x, y, v_x, v_y, b_x, b_y.

    Parameters
    ----------
    since_fix
        Steps since the last node at a fix; above zero there is one more node, at the present.
    fixes, have
        (fix nodes, 2) in m, and which of them arrived.
    effects
        (links, 6) of the inputs, the last one up to the present if `since_fix` is above zero.
    filled
        Whether the arrival state is the filter's own past, which holds the oldest fix already.
    x0, covariance
        (6,) arrival state and (3, 3) its covariance; None for no arrival term.

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
        scale,
        np.where(have[:, None], fixes, 0.0).T,
        effects.reshape(-1, 6).T,
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
    """Rows (rows, 6) on a node's states with their limits (rows,), for those bounds there are.

    The bias is bounded in the IMU's frame: b^b = R' g - R' x4 by Eq. (6).
    """
    rows, shift = np.kron(np.eye(3), _I), np.zeros(6)
    rows[4:, 4:] = -sensors.rotation.T
    shift[4:] = sensors.rotation.T @ np.array(sensors.gravity)
    limit = np.repeat(bounds, 2)
    there = np.isfinite(limit)
    return rows[there], (-limit - shift)[there], (limit - shift)[there]


@lru_cache(maxsize=256)
def _problem(intervals: int, **kind: Any) -> CasadiWindow:
    """A window's problem on two axes; it holds no data, so all estimators share it."""
    return CasadiWindow(intervals, states=6, outputs=2, **kind)
