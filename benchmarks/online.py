"""Measure what one IMU sample costs on board: each scheme's online form, one `update` per sample.

python -m benchmarks.online
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import owtsweep

SCHEMES = ("EKF", "MKF", "HME1", "HME2")


def measure(
    steps: int = 20_000, repeats: int = 5, tunings: tuple[str, ...] = ("paper", "matched")
) -> list[dict[str, Any]]:
    """Measure the cost of each scheme at the default rates, 100 Hz (IMU) and 1 Hz (GNSS).

    Each row is of a scheme under a tuning, in microseconds per IMU step: `median`, `high` (the
    99.9th percentile) and `worst` are of single calls of `update`, and `at_once` is of `run` over
    the whole record.

    The statistics of `update` are over all steps of all repeats, so they include what other
    programs do to the machine. `at_once` is the median over the repeats.
    """
    random = np.random.default_rng(0)
    force = random.normal(size=(steps, 2))
    positions = np.full((steps, 2), np.nan)
    positions[::100] = random.normal(size=(len(positions[::100]), 2))
    fixes = [None if np.isnan(position[0]) else position for position in positions]
    costs: list[dict[str, Any]] = []
    for tuning in tunings:
        for scheme in SCHEMES:
            owtsweep.online(scheme, [f"tuning={tuning}"]).update(force[0], fixes[0])  # compile
            spent = np.empty((repeats, steps))
            whole = np.empty(repeats)
            for repeat in range(repeats):
                estimator = owtsweep.online(scheme, [f"tuning={tuning}"])
                for k in range(steps):
                    began = time.perf_counter()
                    estimator.update(force[k], fixes[k])
                    spent[repeat, k] = time.perf_counter() - began
                estimator = owtsweep.online(scheme, [f"tuning={tuning}"])
                began = time.perf_counter()
                estimator.run(force, positions)
                whole[repeat] = (time.perf_counter() - began) / steps
            median, high = 1e6 * np.quantile(spent, [0.5, 0.999])
            costs.append(
                {
                    "scheme": scheme, "tuning": tuning, "median": float(median),
                    "high": float(high), "worst": 1e6 * float(spent.max()),
                    "at_once": 1e6 * float(np.median(whole)),
                }
            )  # fmt: skip
    return costs


if __name__ == "__main__":
    print("microseconds per IMU step   update: median   99.9 %    worst   run at once")
    for cost in measure():
        print(
            "{scheme:5s} tuning={tuning:8s}{median:20.1f}{high:9.1f}{worst:9.0f}"
            "{at_once:14.2f}".format(**cost)
        )
