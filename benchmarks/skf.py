"""Measure what SKF costs (kernel on eight records, gains, online form), and what SKFA does.

python -m benchmarks.skf
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import owtsweep
from owtsweep.studies import compose
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub import spectral_batch
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import make_records

#: Greatest time of SKF's kernel, ns per state, IMU step and series; of an online step, us; and of
#: SKFA over a record, ns per IMU step and series.
GOALS = (4.0, 100.0, 300.0)
PERIOD, AMPLITUDE = 4.0, 1.0


def main(seconds: float = 2000.0, repeats: int = 5) -> None:
    """Print the times of one thread over `repeats` records of `seconds` each.

    They are medians, but of SKFA over a record the least processor time.
    """
    config = compose(["schemes=[SKF]", "tuning=matched", "sensors=strong_bias", "baselines=[]",
                      f"record.duration={seconds}"])  # fmt: skip
    sensors = sensing.sensors(config.sensors)
    records = make_records(config, PERIOD, range(8))
    known = Known(sensors, config, PERIOD, AMPLITUDE)
    begun = time.perf_counter()
    kernel = resolve("SKF").own_kernel(known, records.steps)
    made = time.perf_counter() - begun
    inside = 0.0
    run = spectral_batch.follow

    def timed(*arguments: Any) -> None:
        nonlocal inside
        began = time.perf_counter()
        run(*arguments)
        inside += time.perf_counter() - began

    spectral_batch.follow = timed
    spent = []
    for _ in range(repeats + 1):  # the first one compiles
        inside = 0.0
        kernel.sum_errors(records, 0, AMPLITUDE)
        spent.append(inside)
    spectral_batch.follow = run
    each = 16 * records.steps * config.skf.states
    print(f"shaping filter (if not cached) and gains of a cell: {made:.2f} s")
    print(
        f"kernel: {np.median(spent[1:]) / each * 1e9:.2f} ns per state, step and series; "
        f"goal {GOALS[0]:g}"
    )
    told = [f"skf.natural_period={PERIOD}", f"skf.amplitude={AMPLITUDE}"]
    time_online("SKF", told, np.zeros((20_000, 2)), np.zeros((200, 2)))
    force, fixes = (array[:, :2] for array in records.measure(AMPLITUDE))
    time_adaptive(force, fixes, repeats)


def time_adaptive(force: Any, fixes: Any, repeats: int) -> None:
    """Print the times of SKFA over a record, shape (steps, 2) and (fixes, 2)."""
    whole = np.full(force.shape, np.nan)
    whole[:: len(force) // len(fixes)] = fixes
    spent = []
    for _ in range(repeats + 1):  # the first one makes the gains, and perhaps fits and compiles
        estimator: Any = owtsweep.online("SKFA", ["sensors=strong_bias"], origin=(0, 0))
        began = time.process_time()
        estimator.run_record(force, whole)
        spent.append(time.process_time() - began)
    each = 2 * len(force)
    print(
        f"SKFA over a record: {min(spent[1:]) / each * 1e9:.0f} ns per step and series; goal "
        f"{GOALS[2]:g}; the first time {spent[0] / each * 1e9:.0f}"
    )
    time_online("SKFA", ["sensors=strong_bias"], force, fixes)


def time_online(name: str, overrides: list[str], force: Any, fixes: Any) -> None:
    """Print the times of a scheme's online steps over a record."""
    estimator = owtsweep.online(name, overrides, origin=(0, 0))
    between, times = len(force) // len(fixes), []
    for k, sample in enumerate(force):
        fix = None if k % between else fixes[k // between]
        began = time.perf_counter()
        estimator.update(sample, fix)
        times.append(time.perf_counter() - began)
    print(
        f"{name} online: {np.median(times) * 1e6:.0f} us per step (median); goal {GOALS[1]:g}; "
        f"longest {max(times) * 1e3:.1f} ms"
    )


if __name__ == "__main__":
    main()
