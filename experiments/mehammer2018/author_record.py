"""Measure what the author's files say of figure 8 and of SIMA's record.

    python -m experiments.mehammer2018.author_record FOLDER [TABLE]

FOLDER holds SIMA_data.mat, and truex.mat and truey.mat of "Test 15_1%", from the repository that
the paper names (its reference [12]). These files have no licence, so this project keeps numbers of
them only: TABLE (default: author_record.csv), with the columns state, measure, estimate, value.
The kept one is beside this script.

- Test 15 is the decay of the buoy at 300 Hz. KF is the steady predictor with the author's Q and R;
  its position errors are those that the author's files hold, within 2 %. OBSERVER is rows 7 to 9
  of truex. The truth of a velocity is the derivative of the measured position below 2 Hz, without
  phase. Measures: `rms_error` of KF's position (m); `velocity_rms` (m/s); `high`, the rms of the
  velocity above 2 Hz (m/s); `lag` (ms). The first and last 2 s do not count.
- SIMA's accelerations, integrated from its first positions and velocities: `drift`, the largest
  distance to its positions (m).
"""

import sys
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.io import loadmat
from scipy.linalg import solve_discrete_are
from scipy.signal import butter, sosfiltfilt

from experiments.mehammer2018.scenarios import integrate
from experiments.mehammer2018.scores import SMOOTH, find_high
from owtsweep.estimation.kinematic_predictor import predict_steady
from owtsweep.evaluation.signals import find_lag

STEP, SIMA_STEP = 0.01 / 3.0, 0.05  # s
STATES = ("x", "y", "z")
ENDS = 2.0  # s


def predict(position, acceleration):
    """Return position and velocity by the author's steady predictor, (steps, 2).

    As in FYP_physical.m: noise of 20 dB of the acceleration moves the position, of 100 dB the
    velocity, both held over a step. R is that of 20 dB of a series that is zero but at its start.
    """
    power = np.mean(acceleration**2)
    moved = np.array([[STEP, 0.5 * STEP**2], [0.0, STEP]])
    Q = moved @ np.diag([1e-2 * power, 1e-10 * power]) @ moved.T
    R = np.array([[1e-2 * position[0] ** 2 / len(position)]])
    A, C = np.array([[1.0, STEP], [0.0, 1.0]]), np.array([[1.0, 0.0]])
    P = solve_discrete_are(A.T, C.T, Q, R)
    gain = np.repeat(A @ P @ C.T / (C @ P @ C.T + R), 2, axis=1)
    start = np.array([position[0], (position[1] - position[0]) / STEP])
    found = np.empty((len(position), 2)), np.empty(len(position))
    predict_steady(position, acceleration, np.empty(0), STEP, gain, 1.0, start, found)
    return found[0]


def judge_decay(folder):
    measured, states = (loadmat(folder / f"{n}.mat")[n] for n in ("truey", "truex"))
    low = butter(4, SMOOTH, fs=1.0 / STEP, output="sos")
    kept = slice(round(ENDS / STEP), -round(ENDS / STEP))
    rows = []
    for i, state in enumerate(STATES):
        position, acceleration = measured[i], measured[9 + i]
        truth = np.gradient(sosfiltfilt(low, position), STEP)[kept]
        estimate = predict(position, acceleration)
        error = np.sqrt(np.mean((estimate[:, 0] - position) ** 2))
        rows.append((state, "rms_error", "KF", error))
        for name, velocity in (("KF", estimate[:, 1]), ("OBSERVER", states[6 + i])):
            error = np.sqrt(np.mean((velocity[kept] - truth) ** 2))
            lag = 1e3 * find_lag(truth[:, None], velocity[kept][:, None], STEP, 0.5)[0]
            rows += [
                (state, "velocity_rms", name, error),
                (state, "high", name, find_high(velocity[kept], STEP)),
                (state, "lag", name, lag),
            ]
    return rows


def judge_sima(folder):
    sima = loadmat(folder / "SIMA_data.mat")
    position, velocity, acceleration = (sima[name][:3].T for name in ("Pos", "V", "Acc"))
    found, _ = integrate(np.stack([position[0], velocity[0]]), acceleration, SIMA_STEP)
    drift = np.max(np.abs(found - position), axis=0)
    return [(state, "drift", "SIMA", value) for state, value in zip(STATES, drift, strict=True)]


def main(folder, file):
    rows = judge_decay(folder) + judge_sima(folder)
    table = pd.DataFrame(rows, columns=["state", "measure", "estimate", "value"])
    table.to_csv(file, index=False, float_format="%.4g")
    print(table.to_string(index=False))


if __name__ == "__main__":
    main(Path(sys.argv[1]), Path(sys.argv[2] if len(sys.argv) > 2 else "author_record.csv"))
