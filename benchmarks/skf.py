"""Measure what SKF costs: its kernel on eight records, its gains, and its online form.

python -m benchmarks.skf
"""

from __future__ import annotations

import time
from typing import Any

import numpy as np

import owtsweep
from owtsweep.studies import compose
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.kernels import spectral
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.schemes import resolve

#: Greatest time of the kernel, ns per state, IMU step and series, and of an online step, us.
GOALS = (4.0, 100.0)
PERIOD, AMPLITUDE = 4.0, 1.0


def main(seconds: float = 2000.0, repeats: int = 5) -> None:
    """Print the times of one thread, medians over `repeats` records of `seconds` each."""
    config = compose(["schemes=[SKF]", "tuning=matched", "sensors=strong_bias", "baselines=[]",
                      f"record.duration={seconds}"])  # fmt: skip
    sensors = sensing.sensors(config.sensors)
    records = make_records(config, PERIOD, range(8))
    scheme: Any = resolve("SKF")
    scheme = scheme.told(config, PERIOD, AMPLITUDE)
    begun = time.perf_counter()
    kernel = scheme.own_kernel(sensors, config, records.steps)
    made = time.perf_counter() - begun
    inside = 0.0
    run = spectral.advance

    def timed(*arguments: Any) -> None:
        nonlocal inside
        began = time.perf_counter()
        run(*arguments)
        inside += time.perf_counter() - began

    spectral.advance = timed
    spent = []
    for _ in range(repeats + 1):  # the first one compiles
        inside = 0.0
        kernel.sum_errors(records, 0, AMPLITUDE)
        spent.append(inside)
    spectral.advance = run
    each = 16 * records.steps * config.skf.states
    print(f"shaping filter (if not cached) and gains of a cell: {made:.2f} s")
    print(
        f"kernel: {np.median(spent[1:]) / each * 1e9:.2f} ns per state, step and series; "
        f"goal {GOALS[0]:g}"
    )
    told = [f"skf.natural_period={PERIOD}", f"skf.amplitude={AMPLITUDE}"]
    estimator = owtsweep.online("SKF", told, origin=(0, 0))
    zero, times = np.zeros(2), []
    for k in range(20_000):
        began = time.perf_counter()
        estimator.update(zero, None if k % 100 else zero)
        times.append(time.perf_counter() - began)
    print(f"online: {np.median(times) * 1e6:.0f} us per step (median); goal {GOALS[1]:g}")


if __name__ == "__main__":
    main()
