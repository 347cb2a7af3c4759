"""Batch least squares of a lift by GTSAM's factor graphs, the bound for smoothers of the blade.

    python -m benchmarks.blade_batch

Of one record: fibre-optic gyroscopes, GNSS of 6 mm, no outage. Each node is a fix; between two,
`CombinedImuFactor` preintegrates the samples (Forster et al. 2017), `GPSFactorArm` knows the lever.
It needs the package gtsam (extra `bench`).
"""

from __future__ import annotations

import numpy as np

from benchmarks.timing import timed
from experiments.maes2018.scenarios import Record, make_record
from owtsweep.gravity import GRAVITY
from owtsweep.studies.blade.contract import Measured, Setting
from owtsweep.studies.blade.schemes.mekf import Navigator

#: Largest ratio of our smoother's error to that of the batch.
AGREEMENT = 1.06


def optimise(setting: Setting, measured: Measured, nodes: np.ndarray) -> np.ndarray:
    """Return positions of the root at the samples `nodes` (n,) of fixes, m, shape (n, 3)."""
    import gtsam
    from gtsam.symbol_shorthand import B, V, X

    def noise(sigmas):
        return gtsam.noiseModel.Diagonal.Sigmas(np.asarray(sigmas, dtype=float))

    parameters = gtsam.PreintegrationCombinedParams.MakeSharedU(GRAVITY)
    for name, sigma in (
        ("Accelerometer", setting.force_sigma * np.sqrt(setting.step)),
        ("Gyroscope", setting.rate_sigma * np.sqrt(setting.step)),
        ("BiasAcc", setting.force_walk),
        ("BiasOmega", setting.rate_walk),
        ("Integration", 1e-7),
    ):
        getattr(parameters, f"set{name}Covariance")(sigma**2 * np.eye(3))
    states = Navigator(setting).filter(measured).states
    position, velocity, tilt, heading = setting.start_sigma
    none = gtsam.imuBias.ConstantBias()
    graph, values = gtsam.NonlinearFactorGraph(), gtsam.Values()
    (given, given_velocity), rotation = setting.start
    start = gtsam.Pose3(gtsam.Rot3(rotation), given)
    graph.add(gtsam.PriorFactorPose3(X(0), start, noise([tilt, tilt, heading, *[position] * 3])))
    graph.add(gtsam.PriorFactorVector(V(0), given_velocity, noise([velocity] * 3)))
    biases = noise([*[setting.force_bias] * 3, *[setting.rate_bias] * 3])
    graph.add(gtsam.PriorFactorConstantBias(B(0), none, biases))
    of_fix = noise(setting.fix_sigma)
    for i, k in enumerate(nodes):
        s = states[k]
        pose = gtsam.Pose3(gtsam.Rot3.Quaternion(*s[6:10]), s[:3])
        values.insert(X(i), pose)
        values.insert(V(i), s[3:6])
        values.insert(B(i), gtsam.imuBias.ConstantBias(s[10:13], s[13:16]))
        graph.add(
            gtsam.GPSFactorArm(X(i), measured.fixes[k, 0], setting.geometry.levers[0], of_fix)
        )
        if i == 0:
            continue
        between = gtsam.PreintegratedCombinedMeasurements(parameters, none)
        for j in range(nodes[i - 1], k):
            force, rate = (
                0.5 * (signal[j] + signal[j + 1])
                for signal in (measured.specific_force, measured.rate)
            )
            between.integrateMeasurement(force, rate, setting.step)
        graph.add(gtsam.CombinedImuFactor(X(i - 1), V(i - 1), X(i), V(i), B(i - 1), B(i), between))
    found = gtsam.LevenbergMarquardtOptimizer(graph, values).optimize()
    poses = [found.atPose3(X(i)) for i in range(len(nodes))]
    return np.array([p.translation() + p.rotation().matrix() @ setting.geometry.to_root
                     for p in poses])  # fmt: skip


def compare(record: Record) -> tuple[float, float, float]:
    """Return rms errors in space of SMOOTHER and of the batch at fixes, m, and the batch's time."""
    nodes = np.flatnonzero(np.isfinite(record.measured.fixes[:, 0, 0]))
    batch, spent = timed(lambda: optimise(record.setting, record.measured, nodes))
    judged = nodes >= record.config.record.settled
    ours = record.run("SMOOTHER").root[nodes]
    sizes = [
        float(np.sqrt(np.mean(np.sum((found - record.truth.root[nodes])[judged] ** 2, axis=1))))
        for found in (ours, batch)
    ]
    return sizes[0], sizes[1], spent.wall


def main() -> None:
    """Print both errors, or what is missing."""
    try:
        ours, batch, spent = compare(make_record((), 0))
    except ModuleNotFoundError as error:
        print(f"{error.name} is not installed: pip install 'owtsweep[bench]'")
        return
    agrees = "agrees" if ours < AGREEMENT * batch else "DIFFERS"
    print(
        f"SMOOTHER errs by {1e3 * ours:.2f} mm, GTSAM's batch by {1e3 * batch:.2f} mm in "
        f"{spent:.1f} s: {agrees}"
    )


if __name__ == "__main__":
    main()
