"""What the closed loop of the steady predictor says of an uncompensated delay without noise."""

from __future__ import annotations

import numpy as np

from experiments.mehammer2018.scenarios import Outcome
from owtsweep.arrays import Array
from owtsweep.estimation.kinematic_predictor import make_transition
from owtsweep.studies.floater.schemes.kf_steady import SteadyPredictor


def predict_delayed_error(outcome: Outcome, column: int) -> float:
    """Return the rms error of the position of a degree of freedom without measured rates.

    For a motion exp(i w t) the predictor's error is

        T(z) = C (z I - A + K C)^-1 (K (exp(-i w d) - 1) - r),    z = exp(i w h),

    with the delay d and what the held acceleration leaves of a step,
    r = z x - A x + w^2 B at x = (1, i w). The mean square is the integral of |T|^2 S, with the
    spectrum S of the record itself (Hann's window).

    Parameters
    ----------
    outcome
        Of a scenario with the scheme KF_STEADY, whose delay is in samples.
    column
        Number of the degree of freedom: 0, 1 or 2.
    """
    assert isinstance(outcome.prepared, SteadyPredictor)
    step = outcome.truth.step
    gain = outcome.prepared.gain[column, :, 0]
    x = outcome.truth.position[outcome.settled :, column]
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(x), step)
    power = np.abs(np.fft.rfft(np.hanning(len(x)) * (x - x.mean()))) ** 2
    error = find_error_of_line(omega, step, gain, outcome.scenario.delay * step)
    return float(x.std() * np.sqrt(np.sum(power * np.abs(error) ** 2) / np.sum(power)))


def find_error_of_line(omega: Array, step: float, gain: Array, delay: float) -> Array:
    """Return the complex error of the position for motions exp(i w t), shape as `omega` (rad/s)."""
    A, B = make_transition(step), np.array([0.5 * step**2, step])
    z = np.exp(1j * omega * step)
    state = np.stack([np.ones_like(z), 1j * omega], axis=-1)
    left = z[:, None] * state - state @ A.T + (omega**2)[:, None] * B
    driven = gain * (np.exp(-1j * omega * delay) - 1.0)[:, None] - left
    loop = z[:, None, None] * np.eye(2) - (A - np.outer(gain, [1.0, 0.0]))
    return np.asarray(np.linalg.solve(loop, driven[..., None])[:, 0, 0])
