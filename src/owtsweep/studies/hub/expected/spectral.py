"""Computes the expected settled error of SKF in a cell under the true spectrum, without records.

SKF assumes a shaping filter, whose spectrum is near the true one, which has hard edges. Here the
motion has the true spectrum, so the difference of this error from what SKF states of itself
measures the fit.

It is the limit of long records: the start has died away, and nothing depends on the settling time.
The gains repeat from one fix to the next, so the errors repeat too. Those from the motion are
computed frequency by frequency; those from the sensors' noise solve a Lyapunov equation over the
time between two fixes.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.estimation.late import LateModel, LateRows, copying, measurement_rows, transition
from owtsweep.studies.base.blocks import Labels, make_product_rows
from owtsweep.studies.base.declaration import Judgement, Means
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known
from owtsweep.studies.hub.known_motion import find_known_motion
from owtsweep.studies.hub.schemes.skf import SCHEME, find_motion
from owtsweep.studies.hub.spectral_model import LONGEST_TRANSIENT, make_axes

#: The measures whose errors are computed, and each one's parts along x and y.
MEASURES = ("position", "velocity")
AXES = {"position": ("x", "y"), "velocity": ("vx", "vy")}


class SpectralErrors(NamedTuple):
    """The settled mean square errors of SKF along x and y, means over the time between two fixes.

    true: position (m^2) and velocity ((m/s)^2) under the true spectrum, shape (axes, 2).
    stated: what SKF's covariance says they are: the solution of the periodic Riccati equation of
        SKF's own model, shape (axes, 2).
    """

    true: Array
    stated: Array


def find_expected_errors(
    config: HubConfig, natural_period: float, amplitude: float
) -> SpectralErrors:
    """Compute the errors of SKF at a natural period (s) and an amplitude (m).

    Raises InputError if SKF's filter never settles, because its model has a bias without a walk.
    """
    sensors = sensing.sensors(config.sensors)
    truth = find_known_motion(config, natural_period, amplitude)
    known = Known(sensors, config, natural_period, amplitude)
    axes = make_axes(find_motion(known), config.skf, sensors)
    omega = 2.0 * np.pi * truth.frequency[truth.density > 0.0]
    power = truth.density[truth.density > 0.0] * truth.spacing
    seen = (omega, sensing.force_per_displacement(omega, sensors), sensors.step)
    walk = sensors.bias_walk**2 * sensors.step
    noise = sensors.force_sigma**2, sensors.position_sigma**2, walk
    true, stated = np.empty((2, 2)), np.empty((2, 2))
    for number, axis in enumerate(axes):
        model, rows, outputs = axis.model, axis.gains.find(LONGEST_TRANSIENT), axis.outputs
        of_motion = find_motion_errors(model, rows, outputs, seen, sensors.fix_scale) @ power
        of_noise = find_noise_errors(model, rows, outputs, noise)
        true[number] = truth.variance[number] * of_motion + of_noise
        settled = rows.outputs[-model.interval :]
        stated[number] = np.mean(np.diagonal(settled, axis1=1, axis2=2), axis=0)
    return SpectralErrors(true, stated)


def make_rows(config: HubConfig, periods: Sequence[float], amplitude: float) -> pd.DataFrame:
    """Make the rows of SKF at natural periods (s) and an amplitude (m), in the settled window."""
    rate = config.sensors.imu.rate
    samples = round(config.record.duration * rate) - round(config.measures.settling_time * rate)
    names = [name for measure in MEASURES for name in (*AXES[measure], measure)]
    windows, counts = ["settled"] * len(names), [samples] * len(names)
    tables = []
    for period in periods:
        true = find_expected_errors(config, period, amplitude).true
        products = np.zeros((len(names), 3))  # the value is the last
        products[:, 2] = np.concatenate([true, true.sum(axis=0, keepdims=True)]).T.ravel()
        judged = [Judgement(Means(names, windows, products, counts))]
        cell = {"natural_period": period, "amplitude": amplitude}
        tables.append(
            make_product_rows(Labels(SCHEME.name, cell, [*cell], [0]), judged, apart=False)
        )
    return pd.concat(tables, ignore_index=True)


class ClosedStep(NamedTuple):
    """A step of a filter as a map: state after the measurements = loop state + fast u + slow z.

    loop: factor of the state of the step before, after its copying, shape (N, N).
    fast, slow: factors of the fast measurement u and of the slow measurement z, shape (N,) each;
        `slow` is zero at a step without a slow measurement.
    copy: factor of the state after the measurements that gives the state after copying, (N, N).
    """

    loop: Array
    fast: Array
    slow: Array
    copy: Array


def close_loop(model: LateModel, rows: LateRows) -> list[ClosedStep]:
    """Return the steps of the filter's last interval, which begins with a slow measurement."""
    N, first = rows.fast.shape[1], len(rows.fast) - model.interval
    predict, copy, keep = transition(model), copying(model), np.eye(N)
    fast_row, slow_row = measurement_rows(model)
    steps = []
    for k in range(model.interval):
        fast, slow = rows.fast[first + k], np.zeros(N)
        loop = predict - np.outer(fast, fast_row @ predict)
        if k == 0:
            slow = rows.slow[-1]
            loop = loop - np.outer(slow, slow_row @ loop)
            fast = fast - slow * (slow_row @ fast)
        copied = model.copies > 0 and (k + model.delay) % model.interval == 0
        steps.append(ClosedStep(loop, fast, slow, copy if copied else keep))
    return steps


def find_motion_errors(
    model: LateModel,
    rows: LateRows,
    outputs: Array,
    frequencies: tuple[Array, NDArray[np.complex128], float],
    scale: float = 1.0,
) -> Array:
    """Compute the mean square errors that sinusoidal motions cause.

    The result is for position and velocity per variance of the displacement, 1 and s^-2, shape
    (2, m); means over a cycle.

    model, rows: the filter, with a state of N numbers, n of them states of the shaping filter, and
        its gains until they have settled.
    outputs: rows (2, n) of position and velocity.
    frequencies: the angular frequencies of the motions, rad/s, shape (m,); the fast measurement per
        displacement at each, s^-2, shape (m,); and the time of a step, s.
    scale: the slow measurement per displacement, which the filter takes for 1.
    """
    omega, force, step = frequencies
    steps, n = close_loop(model, rows), len(model.Q)
    N = rows.fast.shape[1]
    # All numbers turn with the motion: the displacement is 1 at every step.
    back, late = np.exp(-1j * omega * step), scale * np.exp(-1j * omega * step * model.delay)

    def follow(each: ClosedStep, state: NDArray[np.complex128]) -> NDArray[np.complex128]:
        measured = np.outer(each.fast, force) + np.outer(each.slow, late)
        return np.asarray((each.loop @ state) * back + measured)

    state, loop = np.zeros((N, len(omega)), complex), np.eye(N)
    for each in steps:
        state = each.copy @ follow(each, state)
        loop = each.copy @ each.loop @ loop
    over_cycle = np.exp(-1j * omega * step * model.interval)
    repeating = np.eye(N) - over_cycle[:, None, None] * loop
    state = np.linalg.solve(repeating, state.T[..., None])[..., 0].T
    truth = np.stack([np.ones(len(omega)), 1j * omega])
    total = np.zeros((2, len(omega)))
    for each in steps:
        state = follow(each, state)
        total += np.abs(outputs @ state[:n] - truth) ** 2
        state = each.copy @ state
    return total / model.interval


def find_noise_errors(
    model: LateModel, rows: LateRows, outputs: Array, noise: tuple[float, float, float]
) -> Array:
    """Compute the mean square errors of position and velocity that the sensors' noise causes.

    They are in m^2 and (m/s)^2, means over a cycle, shape (2,); other parameters are as in
    `find_motion_errors`.

    noise: the true variances: of the fast and of the slow measurement's noise, and that which the
        bias gains in a step.
    Raises InputError if the filter does not settle: its model has a bias without a walk.
    """
    from scipy.linalg import solve_discrete_lyapunov

    if model.walk == 0.0:
        raise InputError(
            "skf.q_b: without a bias walk the filter never settles, so it has no settled error; "
            "give a density above zero, e.g. skf.q_b=1e-6"
        )
    r_fast, r_slow, walk = noise
    steps, n = close_loop(model, rows), len(model.Q)
    N = rows.fast.shape[1]
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
    return total / model.interval
