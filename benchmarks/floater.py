"""Measure what the floater study's linear filters cost, KF beside filterpy's with twelve states.

    python -m benchmarks.floater

On one thread of this process, over a record of the default length that is made here. filterpy gets
the matrices of Eqs. (8) to (10), all twelve states in one, over the first steps of the record, with
and without losses; its estimates must agree.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from benchmarks.timing import seconds, timed
from owtsweep.estimation.kinematic_predictor import make_transition
from owtsweep.studies.floater.contract import Estimates, Measured, Setting
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.tuning import Tuning

#: Greatest time of a scheme over a record, s; least ratio to filterpy; largest difference to it, of
#: the noise of positions.
RECORD, FASTER, AGREEMENT = 0.01, 50.0, 1e-9
#: Sampling interval in s, samples of a record, and steps over which filterpy is timed.
STEP, STEPS, PEER_STEPS = 0.05, 10_000, 2000
#: Shares of reports lost beside filterpy.
LOSSES = (0.0, 0.2)
#: Delays of reports in s at which schemes that compensate them are timed.
DELAYS = (0.0, 0.05, 0.8)
NAMES = ("KF_STEADY", "KF", "KF_CONSISTENT", "KF_BIAS", "KF_DELAY", "KF_REPAIRED", "FIXED_LAG")


def make_record(delay: float, loss: float) -> tuple[Setting, Measured]:
    """Return a record of slow sines with noise of 20 dB, and what schemes know of it."""
    rng = np.random.default_rng(21)
    size, omega = np.array([3.5, 1.0, 0.5, 0.01, 0.02, 0.015]), 2.0 * np.pi / 38.0
    times = np.arange(STEPS)[:, None] * STEP
    phase = rng.uniform(0.0, 2.0 * np.pi, 6)
    sigma = np.outer([1.0, omega, omega**2], size) / np.sqrt(2.0)
    noise = 0.1 * sigma[:, None] * rng.standard_normal((3, STEPS, 6))
    position = size * np.sin(omega * (times - delay) + phase) + noise[0]
    lost = rng.random(STEPS) < loss
    lost[0] = False
    velocity = omega * size * np.cos(omega * times + phase) + noise[1]
    measured = Measured(
        STEP,
        np.where(lost[:, None], np.nan, position),
        np.full(STEPS, delay),
        lost,
        -(omega**2) * size * np.sin(omega * times + phase) + noise[2],
        velocity[:, 3:],
        None,
    )
    tuning = Tuning(
        losses="known", process="truth", process_share=0.1, bias="truth", bias_share=0.03,
        delay="truth", delay_declared=0.0, attitude="reported", angular_share=2.0, lag=1.0,
        start="report", cutoff=1.0, crossover=1.0, observer=1.0,
    )  # fmt: skip
    believed = 0.1 * sigma
    setting = Setting(
        STEP, believed[0], believed[1, 3:], believed[2], 0.03 * sigma[2], np.zeros(6), delay, sigma,
        np.full(6, omega), False, False, tuning,
    )  # fmt: skip
    return setting, measured


def filter_by_peer(setting: Setting, measured: Measured) -> tuple[np.ndarray, float]:
    """Run filterpy's KalmanFilter; return positions (PEER_STEPS, 6) and the time per step in s."""
    from filterpy.kalman import KalmanFilter

    peer = KalmanFilter(dim_x=12, dim_z=9, dim_u=6)
    G = np.kron([[STEP, STEP**2 / 2.0], [0.0, STEP]], np.eye(6))
    peer.F = np.kron(make_transition(STEP), np.eye(6))
    peer.B = np.kron([[STEP**2 / 2.0], [STEP]], np.eye(6))
    peer.H = np.eye(12)[[0, 1, 2, 3, 4, 5, 9, 10, 11]]
    peer.Q = G @ np.diag(np.tile(setting.acceleration_sigma**2, 2)) @ G.T
    peer.R = np.diag(np.concatenate([setting.position_sigma, setting.rate_sigma]) ** 2)
    peer.x = np.concatenate([measured.position[0], np.zeros(6)])[:, None]
    peer.P = np.diag(np.concatenate([setting.position_sigma, setting.motion_sigma[1]]) ** 2)
    assert measured.acceleration is not None
    inputs = measured.acceleration[:, :, None]
    outputs = np.hstack([measured.position, measured.rate])
    found = np.empty((PEER_STEPS, 6))

    def run() -> None:
        for k in range(PEER_STEPS):
            found[k] = peer.x[:6, 0]
            if measured.lost[k]:
                peer.update(outputs[k, 6:, None], R=peer.R[6:, 6:], H=peer.H[6:])
            else:
                peer.update(outputs[k, :, None])
            peer.predict(inputs[k])

    _, spent = timed(run)
    return found, spent.wall / PEER_STEPS


def main() -> None:
    """Print all measurements beside their goals."""
    for loss in LOSSES:
        setting, measured = make_record(0.0, loss)
        prepared = SCHEMES.resolve("KF").prepare(setting)
        ours: Estimates = prepared.run(measured)
        spent = seconds(partial(prepared.run, measured)) / STEPS
        theirs, each = filter_by_peer(setting, measured)
        apart = np.max(np.abs(theirs - ours.position[:PEER_STEPS]) / setting.position_sigma)
        print(
            f"KF, {loss:.0%} of reports lost: {spent * 1e6:.2f} us a step of twelve states; "
            f"filterpy {each * 1e6:.0f} us, {each / spent:.0f} times as long (goal {FASTER:g}), "
            f"and {'agrees' if apart <= AGREEMENT else 'DIFFERS'} ({apart:.0e} of the noise)"
        )
    for delay in DELAYS:
        setting, measured = make_record(delay, 0.0)
        print(f"a record of {STEPS} samples, reports {delay:g} s late (goal {RECORD * 1e3:g} ms):")
        for name in NAMES:
            prepared = SCHEMES.resolve(name).prepare(setting)
            spent = seconds(partial(prepared.run, measured))
            gains = seconds(partial(SCHEMES.resolve(name).prepare, setting))
            print(f"  {name}: {spent * 1e3:.1f} ms, made ready in {gains * 1e3:.2f} ms")


if __name__ == "__main__":
    main()
