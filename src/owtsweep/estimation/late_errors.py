"""Computes the expected errors of a filter with a late slow measurement, once it has settled.

The gains repeat from one slow measurement to the next, so the errors repeat too. The motion need
not be what the filter's model says: its errors are computed frequency by frequency. The errors from
the sensors' noise solve a Lyapunov equation over one cycle. No record is simulated.

The filter is that of `estimation.late_model`, with a state of N numbers.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.late_gains import LateGains, LateModel, copying, transition


class ClosedStep(NamedTuple):
    """A step of a filter as a map: state after the measurements = loop state + fast u + slow z.

    Attributes
    ----------
    loop
        Factor of the state of the step before, after its copying, shape (N, N).
    fast, slow
        Factors of the fast measurement u and of the slow measurement z, shape (N,) each; `slow` is
        zero at a step without a slow measurement.
    copy
        Factor of the state after the measurements that gives the state after copying, (N, N).
    """

    loop: Array
    fast: Array
    slow: Array
    copy: Array


def close_loop(model: LateModel, gains: LateGains) -> list[ClosedStep]:
    """Return the steps of the filter's last cycle, which begins with a slow measurement."""
    n, N, first = len(model.Q), gains.fast.shape[1], gains.rows - gains.cycle
    predict, copy, keep = transition(model), copying(model), np.eye(N)
    fast_row, slow_row = np.zeros(N), np.zeros(N)
    fast_row[:n], fast_row[n] = model.fast, 1.0
    if model.copies:
        slow_row[-1] = 1.0
    else:
        slow_row[:n] = model.slow
    steps = []
    for k in range(gains.cycle):
        fast, slow = gains.fast[first + k], np.zeros(N)
        loop = predict - np.outer(fast, fast_row @ predict)
        if k == 0:
            slow = gains.slow[-1]
            loop = loop - np.outer(slow, slow_row @ loop)
            fast = fast - slow * (slow_row @ fast)
        copied = model.copies > 0 and (k + model.delay) % model.interval == 0
        steps.append(ClosedStep(loop, fast, slow, copy if copied else keep))
    return steps


def find_motion_errors(
    model: LateModel,
    gains: LateGains,
    outputs: Array,
    frequencies: tuple[Array, NDArray[np.complex128], float],
    scale: float = 1.0,
) -> Array:
    """Compute the mean square errors that sinusoidal motions cause.

    Parameters
    ----------
    model, gains
        The filter, with a state of N numbers, n of them states of the shaping filter.
    outputs
        Rows (2, n) of position and velocity.
    frequencies
        The angular frequencies of the motions, rad/s, shape (m,); the fast measurement per
        displacement at each, s^-2, shape (m,); and the time of a step, s.
    scale
        The slow measurement per displacement, which the filter takes for 1.

    Returns
    -------
    Array
        Mean square errors of position and velocity per variance of the displacement, 1 and s^-2,
        shape (2, m); means over a cycle.
    """
    omega, force, step = frequencies
    steps, n = close_loop(model, gains), len(model.Q)
    N = gains.fast.shape[1]
    # All numbers turn with the motion: the displacement is 1 at every step.
    back, late = np.exp(-1j * omega * step), scale * np.exp(-1j * omega * step * model.delay)
    state, loop = np.zeros((N, len(omega)), complex), np.eye(N)
    for each in steps:
        state = each.copy @ _follow(each, state, back, force, late)
        loop = each.copy @ each.loop @ loop
    over_cycle = np.exp(-1j * omega * step * gains.cycle)
    repeating = np.eye(N) - over_cycle[:, None, None] * loop
    state = np.linalg.solve(repeating, state.T[..., None])[..., 0].T
    truth = np.stack([np.ones(len(omega)), 1j * omega])
    total = np.zeros((2, len(omega)))
    for each in steps:
        state = _follow(each, state, back, force, late)
        total += np.abs(outputs @ state[:n] - truth) ** 2
        state = each.copy @ state
    return total / gains.cycle


def _follow(
    each: ClosedStep,
    state: NDArray[np.complex128],
    back: NDArray[np.complex128],
    force: NDArray[np.complex128],
    late: NDArray[np.complex128],
) -> NDArray[np.complex128]:
    """Return the state (N, m) after a step's measurements, in numbers that turn with the motion."""
    result = (each.loop @ state) * back
    result += np.outer(each.fast, force) + np.outer(each.slow, late)
    return np.asarray(result)


def find_noise_errors(
    model: LateModel, gains: LateGains, outputs: Array, noise: tuple[float, float, float]
) -> Array:
    """Compute the mean square errors of position and velocity that the sensors' noise causes.

    Parameters
    ----------
    model, gains, outputs
        As for `find_motion_errors`.
    noise
        The true variances: of the fast and of the slow measurement's noise, and that which the bias
        gains in a step.

    Returns
    -------
    Array
        Mean square errors of position (m^2) and velocity ((m/s)^2), means over a cycle, (2,).

    Raises
    ------
    InputError
        If the filter does not settle: its model has a bias without a walk.
    """
    from scipy.linalg import solve_discrete_lyapunov

    if model.walk == 0.0:
        raise InputError(
            "skf.q_b: without a bias walk the filter never settles, so it has no settled error; "
            "give a density above zero, e.g. skf.q_b=1e-6"
        )
    r_fast, r_slow, walk = noise
    steps, n = close_loop(model, gains), len(model.Q)
    N = gains.fast.shape[1]
    # the bias in this state is the estimate's error, which the true bias' walk moves
    moved = np.zeros((N, N))
    moved[n, n] = walk

    def follow(each: ClosedStep, P: Array) -> Array:
        added = r_fast * np.outer(each.fast, each.fast) + r_slow * np.outer(each.slow, each.slow)
        return np.asarray(each.loop @ (P + moved) @ each.loop.T + added)

    added, loop = np.asarray(np.zeros((N, N))), np.eye(N)
    for each in steps:
        added = each.copy @ follow(each, added) @ each.copy.T
        loop = each.copy @ each.loop @ loop
    P: Array = solve_discrete_lyapunov(loop, added)
    total = np.zeros(2)
    for each in steps:
        P = follow(each, P)
        total += np.einsum("ci,ij,cj->c", outputs, P[:n, :n], outputs)
        P = each.copy @ P @ each.copy.T
    return total / gains.cycle
