"""Compare the closed form of the moving horizon estimator with other solvers (peers).

The job is to compute the newest state of one window of HME2: two axes, states x, y, v_x, v_y, b_x,
b_y, N_m fix intervals, no constraint. Arrival state and covariance are given and contain the oldest
fix. Problems are built before the clock starts; then only the data change. Every answer is compared
with that of the closed form.
"""

from __future__ import annotations

import contextlib
import io
import warnings
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from benchmarks import STUDY
from benchmarks.timing import REPEATS, seconds
from owtsweep.estimation.casadi_window import CasadiWindow
from owtsweep.estimation.mhe import WindowWeights, square_root_information, window_maps
from owtsweep.studies import compose
from owtsweep.studies.hub.horizon import horizon
from owtsweep.studies.hub.sensors import sensors

#: Answers agree if they differ by at most this fraction of the largest magnitude of the states. It
#: is not smaller because IPOPT stops at a tolerance of its own.
AGREEMENT = 1e-4
PAIRS = 10


@dataclass(frozen=True)
class Window:
    """The data of one window of n fix intervals.

    `z` are the position fixes, shape (n + 1, 2). `effects` are the effects of the inputs on the
    state over each interval, shape (n, 6). `x0` is the arrival state, shape (6,), and `covariance`
    the arrival covariance of one axis, shape (3, 3).
    """

    weights: WindowWeights
    z: np.ndarray
    effects: np.ndarray
    x0: np.ndarray
    covariance: np.ndarray

    @property
    def intervals(self) -> int:
        return len(self.effects)


Solver = Callable[[Window], np.ndarray]


def make_window(intervals: int = 20) -> Window:
    """Make a window with the model of HME2 (tuning=matched) and random data."""
    config: Any = compose([STUDY[0], "tuning=matched"])
    weights = horizon(config.hme.mhe, sensors(config.sensors)).weights
    random = np.random.default_rng(1)
    return Window(
        weights=weights,
        z=random.normal(size=(intervals + 1, 2)),
        effects=random.normal(size=(intervals, 6)) * [0.1, 0.1, 0.1, 0.1, 0.0, 0.0],
        x0=random.normal(size=6) * 0.1,
        covariance=np.diag([0.01, 0.01, 0.01]),
    )


def measure(intervals: int = 20, repeats: int = REPEATS) -> list[dict[str, object]]:
    """Measure all solvers; return one row per solver.

    Each row has seconds per window, whether the answer agrees with that of the closed form, the
    relative error, and a note. For a solver that is not installed, times are None.
    """
    window = make_window(intervals)
    expected = closed_form(window)(window)
    # In turn, so that no solver starts from its own last answer to the same data.
    turns = [window, replace(window, z=-window.z, effects=-window.effects, x0=-window.x0)] * PAIRS
    rows: list[dict[str, object]] = []
    for name, note, make in PEERS:
        try:
            with contextlib.redirect_stdout(io.StringIO()), warnings.catch_warnings():
                warnings.simplefilter("ignore")
                solve = make(window)
                error = float(np.max(np.abs(solve(window) - expected) / np.max(np.abs(expected))))
                work = partial(_all, solve, turns)
                taken = seconds(work, repeats=repeats) / len(turns)
        except ImportError as missing:
            rows.append(
                {"peer": name, "seconds": None, "agrees": None, "note": f"skipped: {missing}"}
            )
            continue
        rows.append(
            {
                "peer": name,
                "seconds": taken,
                "agrees": error <= AGREEMENT,
                "error": error,
                "note": note,
            }
        )
    return rows


def _all(solve: Solver, windows: list[Window]) -> None:
    for window in windows:
        solve(window)


def closed_form(window: Window) -> Solver:
    """Make owtsweep's solver, which multiplies the window's data by a fixed matrix."""
    (map_,) = window_maps(
        window.weights, window.intervals, [window.covariance], use_first_fix=False
    )

    def solve(w: Window) -> np.ndarray:
        data = np.concatenate([w.z, w.effects.reshape(-1, 2), w.x0.reshape(-1, 2)])
        return (map_ @ data).ravel()

    return solve


def _casadi(solver: str) -> Callable[[Window], Solver]:
    def make(window: Window) -> Solver:
        problem = CasadiWindow(
            window.intervals,
            states=6,
            outputs=2,
            last_node=False,
            arrival=True,
            use_first_fix=False,
            solver=solver,
        )
        I2 = np.eye(2)
        weights = window.weights
        deviation = np.sqrt(np.diagonal(weights.link_covariance))
        scale = np.kron([np.sqrt(weights.fix_variance), deviation[1], deviation[2]], [1.0, 1.0])
        packed = [
            np.kron(weights.transition, I2),
            np.kron(weights.transition, I2),
            np.kron(square_root_information(weights.link_covariance), I2),
            np.full(window.intervals + 1, 1.0 / np.sqrt(weights.fix_variance)),
        ]
        prior = np.kron(square_root_information(window.covariance), I2)
        none, no_rows = np.zeros((2, window.intervals + 1, 0)), np.zeros((0, 6))

        def solve(w: Window) -> np.ndarray:
            # One solve, as anybody would; the package itself refines the answer by a second.
            nodes = problem._minimum(none, scale, no_rows, w.z.T, w.effects.T, *packed, w.x0, prior)
            return nodes[:, -1]

        return solve

    return make


def _osqp(window: Window) -> Solver:
    """Make a solver with OSQP: least squares as the quadratic program 1/2 X' J'J X - (J' d)' X.

    X are the states at all nodes of the window; `_least_squares` gives J and d.
    """
    import osqp
    from scipy import sparse

    J, data = _least_squares(window)
    scale = 1.0 / np.linalg.norm(J, axis=0)
    J = J * scale
    solver = osqp.OSQP()
    free = sparse.csc_matrix((1, J.shape[1]))
    solver.setup(
        P=sparse.csc_matrix(np.triu(J.T @ J)), q=np.zeros(J.shape[1]), A=free, l=np.array([-1.0]),
        u=np.array([1.0]), verbose=False, eps_abs=1e-9, eps_rel=1e-9, polishing=True,
        max_iter=20_000,
    )  # fmt: skip

    def solve(w: Window) -> np.ndarray:
        solver.update(q=-J.T @ data(w))
        return np.asarray(solver.solve().x * scale)[-6:]

    return solve


def _least_squares(window: Window) -> tuple[np.ndarray, Callable[[Window], np.ndarray]]:
    """Return the whitened least-squares problem J X = d: J, and a function that computes d.

    X are the states at all nodes of the window, one below the other.
    """
    n, I2 = window.intervals, np.eye(2)
    sigma = np.sqrt(window.weights.fix_variance)
    link = np.kron(square_root_information(window.weights.link_covariance), I2)
    A = np.kron(window.weights.transition, I2)
    prior = np.kron(square_root_information(window.covariance), I2)
    rows = 2 * (n + 1) + 6 * n + 6
    J = np.zeros((rows, 6 * (n + 1)))
    for i in range(1, n + 1):
        J[2 * i : 2 * i + 2, 6 * i : 6 * i + 2] = I2 / sigma
    for i in range(n):
        at = slice(2 * (n + 1) + 6 * i, 2 * (n + 1) + 6 * (i + 1))
        J[at, 6 * i : 6 * i + 6], J[at, 6 * i + 6 : 6 * i + 12] = -link @ A, link
    J[-6:, :6] = prior

    def data(w: Window) -> np.ndarray:
        return np.concatenate([w.z.ravel() / sigma, (w.effects @ link.T).ravel(), prior @ w.x0])

    return J, data


def _do_mpc(window: Window) -> Solver:
    """Make a solver with do-mpc's MHE, which uses IPOPT, for the window's model and weights."""
    import casadi as ca
    import do_mpc

    I2 = np.eye(2)
    A = np.kron(window.weights.transition, I2)
    model = do_mpc.model.Model("discrete")
    x = model.set_variable("_x", "x", (6, 1))
    effect = model.set_variable("_u", "effect", (6, 1))
    model.set_meas("z", x[:2], meas_noise=True)
    model.set_meas("effect_meas", effect, meas_noise=False)
    model.set_rhs("x", ca.mtimes(ca.DM(A), x) + effect, process_noise=True)
    model.setup()
    mhe = do_mpc.estimator.MHE(model, [])
    mhe.settings.n_horizon = window.intervals
    mhe.settings.t_step = 1.0
    mhe.settings.store_full_solution = False
    mhe.settings.meas_from_data = True
    mhe.settings.supress_ipopt_output()
    information = [
        np.kron(np.linalg.inv(c), I2) for c in (window.covariance, window.weights.link_covariance)
    ]
    mhe.set_default_objective(
        P_x=information[0], P_v=np.eye(2) / window.weights.fix_variance, P_w=information[1]
    )
    mhe.setup()
    mhe.x0 = window.x0
    mhe.set_initial_guess()
    return _do_mpc_solver(mhe)


def _do_mpc_solver(mhe: Any) -> Solver:
    def solve(w: Window) -> np.ndarray:
        mhe.opt_p_num["_x_prev"] = w.x0
        for k, effect in enumerate(w.effects):  # its measurements stand at the ends of intervals
            mhe.opt_p_num["_y_meas", k] = np.concatenate([w.z[k + 1], effect])
        mhe.solve()
        return np.asarray(mhe.opt_x_num_unscaled["_x", -1, -1]).ravel()

    return solve


#: Name, note, and function that makes the solver for a window. It raises ImportError if the peer is
#: not installed.
PEERS: tuple[tuple[str, str, Callable[[Window], Solver]], ...] = (
    ("owtsweep closed form", "a fixed matrix times the data, in NumPy", closed_form),
    ("CasADi qrqp", "active-set QP, with a check of its gradient", _casadi("qrqp")),
    ("CasADi IPOPT", "interior point, tol 1e-12, with a check of its gradient", _casadi("ipopt")),
    ("OSQP", "operator splitting, eps 1e-9, polished, factorisation kept", _osqp),
    ("do-mpc", "its MHE class over CasADi IPOPT", _do_mpc),
)


if __name__ == "__main__":
    for row in measure():
        print(row)
