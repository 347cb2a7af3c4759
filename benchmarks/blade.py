"""Measure what the blade study's schemes cost, UKF beside filterpy's with fifteen states.

    python -m benchmarks.blade

On one thread of this process, over a record of the default length. filterpy gets rotation vectors
in place of quaternions and the same compiled motion of a state, over the first steps of the record;
its estimates must agree.
"""

from __future__ import annotations

from functools import partial

import numpy as np
from scipy.spatial.transform import Rotation

from benchmarks.timing import seconds, timed
from experiments.maes2018.scenarios import make_record
from owtsweep.estimation.inertial.strapdown import ERRORS, GYROSCOPES, add_noise, move
from owtsweep.studies.blade.contract import PLAN, Measured, Setting
from owtsweep.studies.blade.schemes import SCHEMES
from owtsweep.studies.blade.schemes.navigation import begin, find_noise

#: Greatest time of UKF over a record of 300 s, s; least ratio to filterpy; largest difference, m.
RECORD, FASTER, AGREEMENT = 1.5, 10.0, 1e-3
#: Steps over which filterpy is timed.
PEER_STEPS = 1000


def unfold(x: np.ndarray) -> np.ndarray:
    """Return the state (16,) of a vector with the attitude as rotation vector (15,)."""
    quaternion = Rotation.from_rotvec(x[6:9]).as_quat(scalar_first=True)
    return np.concatenate([x[:6], quaternion, x[9:]])


def fold(s: np.ndarray) -> np.ndarray:
    """Return the vector (15,) of a state (16,)."""
    vector = Rotation.from_quat(s[6:10], scalar_first=True).as_rotvec()
    return np.concatenate([s[:6], vector, s[10:]])


def filter_by_peer(setting: Setting, measured: Measured) -> tuple[np.ndarray, float]:
    """Run filterpy's UnscentedKalmanFilter; return roots (PEER_STEPS, 3) and s per step."""
    from filterpy.kalman import JulierSigmaPoints, UnscentedKalmanFilter

    def carry(x, dt, k):
        s = unfold(x)
        force, rate = measured.specific_force, measured.rate
        mean = 0.5 * (rate[k - 1] + rate[k])
        move(s, dt, force[k - 1], force[k], mean, GYROSCOPES, *np.empty((2, 3, 3)))
        return fold(s)

    def see(x):
        return x[:3] + Rotation.from_rotvec(x[6:9]).apply(PLAN.levers[0])

    points = JulierSigmaPoints(ERRORS, kappa=0.0)
    peer = UnscentedKalmanFilter(ERRORS, 3, measured.step, see, carry, points)
    s, P = begin(setting)
    peer.x, peer.P, peer.R = fold(s), P, np.diag(setting.fix_sigma**2)
    peer.Q = np.zeros((ERRORS, ERRORS))
    add_noise(peer.Q, measured.step, find_noise(setting))
    peer.sigmas_f = points.sigma_points(peer.x, peer.P)  # the first fix comes before a prediction
    found = np.empty((PEER_STEPS, 3))

    def run() -> None:
        for k in range(PEER_STEPS):
            if k > 0:
                peer.predict(k=k)
            if measured.due[k]:
                peer.update(measured.fixes[k, 0])
            found[k] = peer.x[:3] + Rotation.from_rotvec(peer.x[6:9]).apply(PLAN.to_root)

    _, spent = timed(run)
    return found, spent.wall / PEER_STEPS


def main() -> None:
    """Print all measurements beside their goals."""
    record = make_record((), 0)
    setting, measured = record.setting, record.measured
    ours = record.run("UKF")
    spent = seconds(partial(record.run, "UKF"))
    theirs, each = filter_by_peer(setting, measured)
    apart = np.max(np.abs(theirs - ours.root[:PEER_STEPS]))
    whole = each * len(measured.rate)
    print(
        f"UKF: {spent:.2f} s for a record of 300 s (goal {RECORD:g} s); filterpy {whole:.0f} s, "
        f"{whole / spent:.0f} times as long (goal {FASTER:g}), "
        f"and {'agrees' if apart <= AGREEMENT else 'DIFFERS'} ({apart:.0e} m)"
    )
    for name in SCHEMES.listed:
        SCHEMES.resolve(name).prepare(setting)
        print(f"  {name}: {seconds(partial(record.run, name)) * 1e3:.0f} ms")


if __name__ == "__main__":
    main()
