"""How SKFA and HME1 fare in seas that are no single steady peak.

    python -m experiments.moving_sea [FOLDER] [RECORDS]

Three seas, with the sensors of experiment=better and tuning=matched, RECORDS records of 600 s each
(default 8), errors from 120 s on, at four amplitudes (the largest displacement, or the largest
before the sea grows):

- two peaks: half of the variance at .1 Hz, half at .26 Hz;
- moving period: 4 s, falling by 10 % from 150 s to 450 s;
- growing: 4 s, growing tenfold from 150 s to 450 s.

Writes into FOLDER (default: results/better) moving_sea.csv: sea, amplitude (m), scheme, mse (of the
position, m^2), nees (per degree of freedom).
"""

from dataclasses import replace
from itertools import product

import numpy as np
import pandas as pd
from scipy.interpolate import CubicSpline

from experiments.command import read_words, write
from owtsweep.evaluation.loop import run_estimator
from owtsweep.motion.departing import Modulation, modulate
from owtsweep.studies import compose
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import make_records
from owtsweep.studies.hub.sensors import observe

AMPLITUDES = [0.05, 0.2, 1.0, 10.0]
#: The series of a motion.
SERIES = ("position", "velocity", "acceleration", "before")
DURATION, SETTLED, CHANGE = 600.0, 120.0, (150.0, 450.0)


def scale(motion, factor):
    return replace(motion, felt=None, **{name: factor * getattr(motion, name) for name in SERIES})


def add(first, second):
    """Add two motions of equal standard deviation; the sum's largest displacement is 1 m."""
    parts = [scale(motion, 1.0 / np.std(motion.position)) for motion in (first, second)]
    sums = {name: sum(getattr(part, name) for part in parts) for name in SERIES}
    whole = replace(first, felt=None, **sums)
    return scale(whole, 1.0 / np.abs(whole.position).max())


def quicken(motion, share):
    """Let the frequency of a motion rise by `share`, in the time CHANGE and by a smooth step.

    The displacement d(s(t)) has the velocity d' s' and the acceleration d'' s'^2 + d' s''.
    """
    time = motion.step * np.arange(len(motion.position))
    begin, end = CHANGE
    at = np.clip((time - begin) / (end - begin), 0.0, 1.0)
    rate = 1.0 - share * (1.0 - at**2 * (3.0 - 2.0 * at))
    slope = share * 6.0 * at * (1.0 - at) / (end - begin)
    warped = np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1]))]) * motion.step
    series = (motion.position, motion.velocity, motion.acceleration)
    p, v, a = (CubicSpline(time, values)(warped) for values in series)
    return replace(motion, position=p, velocity=v * rate, acceleration=a * rate**2 + v * slope)


def make_seas(config, count):
    """Return name -> motions of unit amplitude, and the noise of the sensors."""
    replicates = list(range(count))
    four, slow, quick = (
        make_records(config, period, replicates) for period in (4.0, 10.0, 1 / 0.26)
    )
    growing = Modulation([[CHANGE[0], 1.0], [CHANGE[1], 10.0]])
    seas = {
        "two peaks": [add(*pair) for pair in zip(slow.motion, quick.motion, strict=True)],
        "moving period": [quicken(motion, 0.1) for motion in four.motion],
        "growing": [modulate(scale(motion, 1.0), growing) for motion in four.motion],
    }
    return seas, four


def judge(scheme, config, records, motion, noise, amplitude):
    """Return the settled MSE of position, and NEES per degree of freedom, of one record."""
    sensors = records.sensors
    whole = observe(motion, records.direction, sensors).add_noise(amplitude, noise)
    estimate = run_estimator(scheme.stream(Known(sensors, config)), *whole, sensors.fix_interval)
    along = (motion.position, motion.velocity)
    truth = np.concatenate([np.outer(each, records.direction) for each in along], axis=1)
    first = round(SETTLED / sensors.step)
    error = (estimate.state - amplitude * truth)[first:]
    weighted = np.linalg.solve(estimate.covariance[first:], error[..., None])[..., 0]
    mse = np.mean(np.sum(error[:, :2] ** 2, axis=1))
    return mse, np.mean(np.sum(error * weighted, axis=1)) / 4.0


def main():
    """Judge both schemes in all seas; write the table."""
    folder, count, _ = read_words("results/better", 8)
    config = compose(["experiment=better", "schemes=[HME1,SKFA]", f"record.duration={DURATION}"])
    seas, records = make_seas(config, count)
    rows = []
    for (sea, motions), amplitude, name in product(seas.items(), AMPLITUDES, ("HME1", "SKFA")):
        judged = [
            judge(resolve(name), config, records, motion, noise, amplitude)
            for motion, noise in zip(motions, records.noise, strict=True)
        ]
        mse, nees = np.mean(judged, axis=0)
        rows.append((sea, amplitude, name, mse, nees))
        print(f"{sea}, {amplitude:g} m, {name}: {mse:.3g} m^2, NEES {nees:.2f}")
    table = pd.DataFrame(rows, columns=["sea", "amplitude", "scheme", "mse", "nees"])
    write(folder, {"moving_sea": table})


if __name__ == "__main__":
    main()
