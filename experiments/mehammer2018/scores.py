"""What is measured of a scenario, for tests of statements: the study's measures, and the paper's.

Relative errors are the paper's: |error| over |x|, in %, of surge. "Away from zero" means where |x|
is at least a tenth of its standard deviation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from experiments.mehammer2018.scenarios import Outcome, integrate
from owtsweep.arrays import Array
from owtsweep.estimation.kinematic_predictor import make_transition
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.measures import compare
from owtsweep.studies.floater.schemes.printed import SteadyPredictor

#: Surge, of which the paper shows figures.
X = 0
#: Away from zero: this part of the standard deviation.
NEAR = 0.1
#: A filter is smooth if little of its velocity is above this frequency in Hz (figure 8b).
SMOOTH = 2.0


def score(outcome: Outcome) -> dict[str, float]:
    """Return measure -> value of one record; those that end with `_x` are per degree of freedom."""
    truth, estimates, setting = outcome.truth, outcome.estimates, outcome.setting
    settled = outcome.settled
    sigma = setting.position_sigma / np.sqrt(outcome.scenario.believed)
    found = compare(truth, estimates, sigma, settled)
    for i, name in enumerate(DOF):
        found[f"rms_{name}"] = np.sqrt(found[f"mse_position_{name}"])
        found[f"velocity_rms_{name}"] = np.sqrt(found[f"mse_velocity_{name}"])
        found[f"high_{name}"] = find_high(estimates.velocity[settled:, i], truth.step)
        # Period of a sine with the same position and acceleration: how slow the motion is.
        found[f"period_{name}"] = (
            2.0 * np.pi * np.sqrt(truth.position[:, i].std() / truth.acceleration[:, i].std())
        )
    relative = find_relative(outcome)[settled:]
    x = truth.position[settled:, X]
    away = np.abs(x) >= NEAR * x.std()
    found |= {
        "share_0.15": float(np.mean(relative < 0.15)),
        "share_0.5": float(np.mean(relative < 0.5)),
        "relative_p99": float(np.percentile(relative[away], 99.0)),
        "peaks_away": float(count_peaks(relative, away, 0.2)),
        "integrated": find_integration_error(truth.position[settled:, X], truth.step),
    }
    delay = outcome.scenario.delay * truth.step
    if delay > 0.0:
        travel = delay * np.sqrt(np.mean(truth.velocity[settled:, X] ** 2))
        found["over_travel"] = found["rms_x"] / travel
        if isinstance(outcome.prepared, SteadyPredictor):
            found["over_closed_loop"] = found["rms_x"] / predict_delayed_error(outcome, X)
    return found


def find_relative(outcome: Outcome) -> Array:
    """Return |error| over |x| of surge in %, shape (steps,)."""
    x = outcome.truth.position[:, X]
    error = np.abs(outcome.estimates.position[:, X] - x)
    return np.asarray(100.0 * error / np.maximum(np.abs(x), np.finfo(float).tiny))


def count_peaks(relative: Array, away: NDArray[np.bool_], least: float) -> int:
    """Return the number of local maxima above `least` (%) where the motion is away from zero.

    A maximum at an end of a stretch away from zero is the flank of a peak at zero.
    """
    inner = (relative[1:-1] > relative[:-2]) & (relative[1:-1] >= relative[2:])
    return int(np.sum(inner & (relative[1:-1] > least) & away[:-2] & away[1:-1] & away[2:]))


def find_high(signal: Array, step: float) -> float:
    """Return the rms of a signal above `SMOOTH` Hz, without its first and last second."""
    from scipy.signal import butter, sosfiltfilt

    high = sosfiltfilt(butter(4, SMOOTH, "highpass", fs=1.0 / step, output="sos"), signal)
    second = round(1.0 / step)
    return float(np.sqrt(np.mean(high[second:-second] ** 2)))


def find_integration_error(position: Array, step: float) -> float:
    """Return the largest error of a position that is differentiated twice and integrated again.

    Velocities and accelerations are those of the kinematic model, which holds accelerations over a
    step (Eq. 9): of three positions follows one acceleration, given the velocity. The start is
    known; what is left is rounding.
    """
    # x(k+1) - 2 x(k) + x(k-1) = h^2 / 2 (a(k) + a(k-1)), so signs alternate; a(0) = a(1) begins.
    total = 2.0 * np.diff(position, 2) / step**2
    sign = (-1.0) ** np.arange(len(position) - 1)
    acceleration = sign * np.cumsum(sign * np.concatenate([[0.5 * total[0]], total]))
    velocity = (position[1] - position[0]) / step - 0.5 * step * acceleration[0]
    start = np.array([[position[0]], [velocity]])
    again, _ = integrate(start, acceleration[:, None], step)
    return float(np.max(np.abs(again[:, 0] - position[:-1])))


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
