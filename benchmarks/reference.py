"""Measure what a step costs with `engine=reference`, and compute the cost of a cell from it.

A cell is one record with all four schemes. The settings are those of the goal: N_s = 20 IMU steps
(smoother window), N_m = 20 GNSS intervals (horizon of the MHE), T_m = 0.1 s (interval of the MHE).
Smoother window and horizon are full before the clock starts, as in nearly all of a record.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from benchmarks import STUDY
from benchmarks.timing import REPEATS, median_time, timed
from owtsweep.studies import compose
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.sensors import observe

SCHEMES = ("EKF", "MKF", "HME1", "HME2")
SETTINGS = ("hme.smoother_window=20", "hme.mhe.horizon=20", "hme.mhe.interval=0.1")
#: Steps of a record of the default study (2000 s at 100 Hz) and cells of its map.
STEPS = 200_000
CELLS = 60


def measure(
    repeats: int = REPEATS,
    intervals: int = 3,
    lead: int = 22,
    settings: Sequence[str] = SETTINGS,
) -> list[dict[str, Any]]:
    """Measure ns per IMU step of a two-axis record; return one row per scheme.

    The time is the median of `repeats` stretches of `intervals` GNSS intervals each. Before them,
    the estimator runs for `lead` GNSS intervals.
    """
    needed = lead + repeats * intervals
    config: Any = compose([*STUDY, "engine=reference", *settings, f"record.duration={needed}"])
    records = make_records(config, 4.0, [0])
    sensors = records.sensors
    moved = observe(records.motion[0], records.direction, sensors)
    force, fixes = moved.add_noise(1.0, records.noise[0])
    M = sensors.fix_interval

    rows = []
    for name in SCHEMES:
        estimator = resolve(name).start_for_runs(Known(sensors, config))

        def feed(first: int, count: int, estimator: Any = estimator) -> None:
            for k in range(first * M, (first + count) * M):
                estimator.update(force[k], np.array(fixes[k // M]) if k % M == 0 else None)

        feed(0, lead)
        times = [
            timed(lambda i=i: feed(lead + i * intervals, intervals))[1] for i in range(repeats)
        ]
        rows.append({"scheme": name, "ns": 1e9 * median_time(times).wall / (intervals * M)})
    return rows


def per_cell(rows: list[dict[str, Any]]) -> float:
    """Compute the seconds for one record of one cell with all schemes, from `measure`'s rows."""
    return sum(row["ns"] for row in rows) * 1e-9 * STEPS


if __name__ == "__main__":
    rows = measure()
    for row in rows:
        print(f"{row['scheme']:5} {1e-3 * row['ns']:9.1f} us per step")
    print(f"one cell, one record of 2000 s, four schemes: {per_cell(rows):.0f} s")
