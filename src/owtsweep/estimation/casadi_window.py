"""The optimisation problem of a window of the moving horizon estimator, solved by CasADi.

`estimation.mhe` says how Eq. (11) of Ren et al. (2019) is read.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from owtsweep.arrays import Array

#: How far beyond a constraint a solution may lie, as a fraction of the allowed range. The
#: tolerance of daqp is 1e-12 of the scaled states; rounding leaves about 1e-9 where weights differ
#: by decades.
FEASIBILITY = 1e-8


class CasadiWindow:
    """The optimisation problem of Eq. (11) of Ren et al. (2019) for one window, solved by CasADi.

    A node is the time of a fix, or the present. Only this class can solve a window with
    constraints. Without constraints, `window_maps` solves the problem in closed form, and the class
    serves to test it. The hub study solves two axes at once: the states are x, y, v_x, v_y, b_x,
    b_y (position, velocity and bias of the accelerometer).

    intervals: number of fixes minus one.
    states, outputs: number of components of a state, and of a fix.
    last_node: whether there is a node at the present time, t_f after the last fix.
    arrival: whether the cost has a term for the difference between the oldest state and the arrival
        state.
    fixed_arrival: whether the oldest state must equal the arrival state.
    use_first_fix: false if the arrival state already includes the oldest fix.
    solver: "qrqp" (an active-set QP solver; equal to the closed form up to rounding) or "ipopt".
    constraints: number of constraints on each node's state. With `fixed_arrival`, the oldest node
        has none.
    Raises ValueError if `solver` is neither "qrqp" nor "ipopt".
    """

    def __init__(
        self,
        intervals: int,
        *,
        states: int,
        outputs: int,
        last_node: bool,
        arrival: bool,
        fixed_arrival: bool = False,
        use_first_fix: bool = True,
        solver: str = "qrqp",
        constraints: int = 0,
    ) -> None:
        import casadi as ca

        nodes = intervals + 1
        X = ca.MX.sym("X", states, nodes + int(last_node))
        z = ca.MX.sym("z", outputs, nodes)
        inputs = ca.MX.sym("inputs", states, intervals + int(last_node))
        A = ca.MX.sym("A", states, states)
        A_f = ca.MX.sym("A_f", states, states)
        link = ca.MX.sym("link", states, states)  # square roots of information
        fix = ca.MX.sym("fix", nodes)
        x0 = ca.MX.sym("x0", states)
        prior = ca.MX.sym("prior", states, states)
        scale = ca.MX.sym("scale", states)
        rows = ca.MX.sym("rows", constraints, states)

        def state(i: int) -> ca.MX:
            return scale * X[:, i]

        cost = ca.MX(0)
        for i in range(0 if use_first_fix else 1, nodes):  # (11c)
            cost += ca.sumsqr(fix[i] * (z[:, i] - state(i)[:outputs]))
        for i in range(intervals):  # (11b)
            cost += ca.sumsqr(ca.mtimes(link, state(i + 1) - ca.mtimes(A, state(i)) - inputs[:, i]))
        if last_node:  # (11d), t_f after the last fix and without a fix of its own (11i)
            predicted = ca.mtimes(A_f, state(intervals)) + inputs[:, intervals]
            cost += ca.sumsqr(ca.mtimes(link, state(nodes) - predicted))
        if arrival:
            cost += ca.sumsqr(ca.mtimes(prior, state(0) - x0))
        parts = (scale, rows, z, inputs, A, A_f, link, fix, x0, prior)
        x, p = ca.vec(X), ca.vertcat(*map(ca.vec, parts))
        free = range(int(fixed_arrival), nodes + int(last_node))
        held = state(0) - x0 if fixed_arrival else ca.MX(0, 1)
        g = ca.vertcat(held, *(ca.mtimes(rows, state(i)) for i in free))
        problem = {"x": x, "p": p, "f": 0.5 * cost, "g": g}
        self._equal = states if fixed_arrival else 0
        self._free = len(free)
        if solver == "qrqp":
            options = {"print_iter": False, "print_header": False, "print_time": False}
            solve = ca.qpsol("mhe", "qrqp", problem, {**options, "error_on_fail": False})
        elif solver == "ipopt":
            quiet: dict[str, Any] = {"print_level": 0, "sb": "yes", "tol": 1e-12}
            solve = ca.nlpsol("mhe", "ipopt", problem, {"ipopt": quiet, "print_time": 0})
        else:
            raise ValueError(f"solver is {solver!r}, neither 'qrqp' nor 'ipopt'")
        self._solvers = [solve]
        if constraints:
            # qrqp sometimes reports success far outside the constraints; daqp, a dual active-set
            # method, then finds the solution
            exact: dict[str, Any] = {"daqp": {"primal_tol": 1e-12}, "error_on_fail": False}
            self._solvers.append(ca.qpsol("mhe", "daqp", problem, exact))
        self._gradient = ca.Function("gradient", [x, p], [ca.gradient(problem["f"], x)])
        force = ca.MX.sym("force", g.shape[0])
        self._pull = ca.Function("pull", [x, p, force], [ca.jtimes(g, x, force, True)])
        self._shape = (states, nodes + int(last_node))

    def solve(
        self,
        scale: Array,
        z: Array,
        inputs: Array,
        *,
        A: Array,
        A_f: Array,
        link: Array,
        fix: float | Array,
        x0: Array,
        prior: Array,
        rows: Array,
        lower: Array,
        upper: Array,
    ) -> Array:
        """Solve the window; return the states of all nodes, shape (states, nodes).

        The solution is refined once: the problem is solved again for the residuals of the first
        solution. Without refinement, the errors reach 1e-10 of the states if the weights differ by
        many decades.

        scale: typical sizes of the states, shape (states,), by which the solver's variables are
            scaled.
        z: position fixes, oldest first, shape (outputs, fixes).
        inputs: effects of the inputs on the state from node to node, shape (states, nodes - 1).
        A, A_f: transition matrices (states, states) between fixes, and from the last fix to the
            present.
        link, prior: square roots U, U' U = covariance^-1, of the process noise between nodes and of
            the arrival state; shape (states, states).
        fix: inverse standard deviation of all fixes, or of each; zero for a missing fix.
        x0: arrival state, shape (states,).
        rows, lower, upper: lower <= rows x <= upper holds for the state x of each node, except the
            oldest if its state is fixed. Shapes (constraints, states), (constraints,) and
            (constraints,).
        Raises ArithmeticError if the solution does not meet the conditions of optimality: the
        gradient of the Lagrangian is not small, a constraint is violated, or an inactive constraint
        has a multiplier. (The solvers' own reports of success are not reliable.)
        """
        nodes = z.shape[1]
        fix = np.broadcast_to(fix, nodes)
        limits = np.repeat(np.stack([lower, upper])[:, None], self._free, axis=1)
        data = (A, A_f, link, fix)
        states = self._minimum(limits, scale, rows, z, inputs, *data, x0, prior)
        predicted = A @ states[:, :-1]
        predicted[:, nodes - 1 :] = A_f @ states[:, nodes - 1 : -1]
        left = (z - states[: len(z), :nodes], inputs - (states[:, 1:] - predicted))
        limits = limits - (rows @ states[:, -self._free :]).T
        return states + self._minimum(limits, scale, rows, *left, *data, x0 - states[:, 0], prior)

    def _minimum(self, limits: Array, scale: Array, rows: Array, *parameters: Array) -> Array:
        """Solve the problem by one solver after the other until one finds a minimum.

        Raises ArithmeticError if none does. `limits` are (2, constrained nodes, constraints).
        """
        parts = (scale, rows, *parameters)
        p = np.concatenate([np.asarray(part, dtype=float).ravel("F") for part in parts])
        equal = np.zeros(self._equal)
        low, high = (np.concatenate([equal, limit.ravel()]) for limit in limits)
        for solve in self._solvers:
            solution = solve(x0=0.0, p=p, lbg=low, ubg=high)
            answer, force = (np.asarray(solution[name]).ravel() for name in ("x", "lam_g"))
            states = answer.reshape(self._shape, order="F") * scale[:, None]
            fault = self._slope_left(answer, p, force)
            fault = fault or self._broken_limit(states, rows, limits, force)
            if not fault:
                return np.asarray(states)
        raise ArithmeticError(f"the MHE's solver stopped {fault}")

    def _slope_left(self, answer: Array, p: Array, force: Array) -> str:
        """Describe the fault if the gradient of the Lagrangian is not small; "" if it is small."""
        slope = np.asarray(self._gradient(answer, p)).ravel()
        start = np.asarray(self._gradient(np.zeros_like(answer), p)).ravel()
        if len(force) > self._equal:
            pull = np.asarray(self._pull(answer, p, force)).ravel()
            slope = slope + pull
            start = np.append(start, pull)  # active constraints set the scale
        slope = slope[self._equal :]
        if not np.max(np.abs(slope)) <= 1e-6 * (1.0 + np.max(np.abs(start))):
            return f"at a gradient of {max(abs(slope)):.2g}"
        return ""

    def _broken_limit(self, states: Array, rows: Array, limits: Array, force: Array) -> str:
        """Describe a violated limit, or a multiplier of one that is not reached; "" for neither."""
        value = (rows @ states[:, -self._free :]).T
        width = limits[1] - limits[0]
        below, above = (value - limits[0]) / width, (limits[1] - value) / width
        if not np.all((below >= -FEASIBILITY) & (above >= -FEASIBILITY)):
            return "at a state that breaks a constraint"
        force = force[self._equal :].reshape(width.shape)
        idle = 1e-6 * (1.0 + np.max(np.abs(force), initial=0.0))
        if np.any((force > idle) & (above > 1e-6)) or np.any((force < -idle) & (below > 1e-6)):
            return "where no constraint holds it"
        return ""
