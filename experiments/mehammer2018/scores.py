"""What is measured of a scenario, for tests of statements: the study's measures, and the paper's.

Relative errors are the paper's: |error| over |x|, in %, of surge. "Away from zero" means where |x|
is at least a tenth of its standard deviation.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from experiments.mehammer2018.closed_loop import predict_delayed_error
from experiments.mehammer2018.scenarios import Outcome, integrate
from owtsweep.arrays import Array
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.measures import compare
from owtsweep.studies.floater.schemes.kf_steady import SteadyPredictor

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
