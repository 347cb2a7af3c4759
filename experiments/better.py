"""How near the schemes come to the bounds in each cell, and what the bounds themselves lean on.

    python -m experiments.better [FOLDER] [REPLICATES] [NAME=VALUE ...]

Runs experiment=better for tuning=matched (100 records per cell by default, below results/), and
writes into FOLDER (default: results/better):

- efficiency.csv: tuning, scheme, natural_period (s), amplitude (m), measure, mse, bound_a, bound_b
  (m^2, of velocity (m/s)^2), of the settled errors, for schemes and baselines;
- bounds.csv: per cell and measure bound_a and bound_b; bound_b on a window of 60 s instead of by
  a recursion (window, and recursion, both for an IMU of 10 Hz with the same noise density); bound_b
  for a spectrum that rolls off outside the band (roll_off); the bound for an estimator that knows
  the direction of the motion too (direction_known);
- efficiency.png and efficiency.svg, of the position's error.

Further arguments are overrides of the run, e.g. grid.amplitude=[0.1,1].
"""

from dataclasses import replace

import numpy as np
import pandas as pd
from scipy.linalg import cholesky, solve_triangular

import owtsweep
from experiments.command import read_words, write
from owtsweep.arrays import Array
from owtsweep.figures import style
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.bounds.cells import (
    BOUNDED,
    WINDOW,
    compute_bounds,
    find_shape,
)
from owtsweep.studies.hub.bounds.known_spectrum import bound_of_known_spectrum
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import describe_origin
from owtsweep.studies.hub.figures import efficiency
from owtsweep.studies.hub.known_motion import REACH, KnownMotion, find_known_motion
from owtsweep.studies.hub.sensors import Sensors

CELL = ["natural_period", "amplitude", "measure"]
COLUMNS = ["tuning", "scheme", *CELL, "mse", "bound_a", "bound_b"]
#: Rate of the IMU (Hz) whose window is short enough to solve, and the window's length (s).
RATE, SECONDS = 10.0, 60.0
#: Standard deviation of the bias at the start of the window: unknown, m/s^2.
BIAS_AT_START = 1.0
#: The frequencies of a spectrum that rolls off reach to this multiple of the band's upper edge.
REACH_OF_ROLL_OFF = 60.0


def make_table(run, bounds):
    """Set the settled errors of a run beside the bounds of their cells; the columns are COLUMNS."""
    summary = run.summary()
    kept = summary[(summary["window"] == WINDOW) & summary["measure"].isin(BOUNDED)]
    table = kept.rename(columns={"mean": "mse"}).merge(bounds, on=CELL, validate="many_to_one")
    return table.assign(tuning=run.config.tuning_name)[COLUMNS]


def check_bounds(config, bounds):
    """Add to the table of bounds what bound (b) is by another way and for other knowledge."""
    sensors = sensing.sensors(config.sensors)
    every = round(1.0 / (RATE * sensors.step))
    slow = replace(
        sensors,
        step=every * sensors.step,
        fix_interval=sensors.fix_interval // every,
        delay=sensors.delay // every,
        force_sigma=sensors.force_sigma / np.sqrt(every),
    )
    rows = []
    for period, amplitude in bounds[CELL[:2]].drop_duplicates().itertuples(index=False):
        known = find_known_motion(config, period, amplitude)
        shape = find_shape(config, known)
        window = sum(np.array(bound_on_window(known, v, slow, SECONDS)) for v in known.variance)
        recursion = sum(np.array(bound_of_known_spectrum(shape, v, slow)) for v in known.variance)
        soft = roll_off(config, period, known)
        tail = find_shape(config, soft)
        softly = sum(np.array(bound_of_known_spectrum(tail, v, sensors)) for v in soft.variance)
        direction = bound_of_known_spectrum(shape, known.variance.sum(), sensors)
        for number, measure in enumerate(BOUNDED):
            further = window[number], recursion[number], softly[number], direction[number]
            rows.append((period, amplitude, measure, *further))
    names = [*CELL, "window", "recursion", "roll_off", "direction_known"]
    return bounds.merge(pd.DataFrame(rows, columns=names), on=CELL, validate="one_to_one")


def roll_off(config: HubConfig, natural_period: float, known: KnownMotion) -> KnownMotion:
    """Return a motion whose spectrum is not zero outside the band.

    There it falls with f^4 towards 0 and with f^-4 upwards. Far above the band it falls with f^-8:
    with f^-4 for ever, the acceleration would have no finite variance.
    """
    shape = config.spectrum.at(natural_period)
    first, last = config.band
    count = np.ceil(REACH_OF_ROLL_OFF * last / known.spacing)
    frequency = known.spacing * (np.arange(count) + 0.5)
    inside = np.clip(frequency, first, last)
    factor = np.minimum(frequency / inside, inside / frequency) ** 4
    density = shape.density(inside) * factor / (1.0 + (frequency / (REACH * last)) ** 4)
    return replace(known, frequency=frequency, density=density / (density.sum() * known.spacing))


def bound_on_window(
    known: KnownMotion, variance: float, sensors: Sensors, seconds: float
) -> tuple[float, float]:
    """Compute the bounds along one axis, of position (m^2) and of velocity ((m/s)^2).

    The covariance of all measurements in a window and of the present motion follows from the
    spectrum by integrals. The best linear estimate of the motion is then a projection (Wiener):
    no rational filter, no recursion, no steady state. The window must be long against the memory of
    the motion and of the bias. It takes the cube of the number of samples: reduce the IMU's rate,
    with a sigma smaller by the root of it, to keep a window short.

    Parameters
    ----------
    known
        The spectrum of the motion; its own variances are not used.
    variance
        Variance of the position along the axis, m^2.
    sensors
        The sensors; their AC coupling and scale of a fix are left out.
    seconds
        Length of the window, s.

    Returns
    -------
    tuple of float
        As `bound_of_known_spectrum`.
    """
    interval = sensors.fix_interval
    fixes = max(round(seconds / sensors.fix_step), 1)
    # the last `interval` steps are those at which estimates are made; a fix arrives at the first
    steps = np.arange(fixes * interval)
    arrivals = steps[::interval]
    arrival = np.concatenate([steps, arrivals])
    order = np.argsort(arrival, kind="stable")
    time = np.concatenate([steps, arrivals - sensors.delay])[order]
    is_fix = (np.arange(len(order)) >= len(steps))[order]

    lags = time[:, None] - time[None, :]
    least = min(int(lags.min()), int(time.min() - steps[-1]))
    table = _Covariances(known, variance, sensors, -least)
    mixed = table.of("force", "position", lags)  # even in the lag
    inertial = np.where(is_fix[:, None] | is_fix, mixed, table.of("force", "force", lags))
    K = np.where(is_fix[:, None] & is_fix, table.of("position", "position", lags), inertial)
    earlier = np.minimum(time[:, None], time)[~is_fix][:, ~is_fix] * sensors.step
    K[np.ix_(~is_fix, ~is_fix)] += BIAS_AT_START**2 + sensors.bias_walk**2 * earlier
    K[np.diag_indices_from(K)] += np.where(
        is_fix, sensors.position_sigma**2, sensors.force_sigma**2
    )
    L = cholesky(K, lower=True)
    errors = []
    for now in steps[-interval:]:
        count = np.count_nonzero(arrival <= now)
        ago = now - time[:count]
        for target in ("position", "velocity"):
            g = np.where(
                is_fix[:count], table.of(target, "position", ago), table.of(target, "force", ago)
            )
            seen = solve_triangular(L[:count, :count], g, lower=True)
            errors.append(table.of(target, target, np.zeros(1, int))[0] - seen @ seen)
    position, velocity = np.reshape(errors, (interval, 2)).mean(axis=0)
    return float(position), float(velocity)


class _Covariances:
    """Covariances of position, velocity and what the IMU feels, over the lag in steps."""

    def __init__(self, known: KnownMotion, variance: float, sensors: Sensors, most: int) -> None:
        omega = 2.0 * np.pi * known.frequency
        phase = np.outer(np.arange(most + 1) * sensors.step, omega)
        weight = variance * known.density * known.spacing
        force = -(omega**2) - sensors.lean
        cos, sin = np.cos(phase), np.sin(phase)
        #: Covariance of the first at t + lag with the second at t, for lags from 0 on.
        self.even = {
            ("position", "position"): cos @ weight,
            ("force", "position"): cos @ (weight * force),
            ("force", "force"): cos @ (weight * force**2),
            ("velocity", "velocity"): cos @ (weight * omega**2),
        }
        self.even["position", "force"] = self.even["force", "position"]
        self.odd = {
            ("velocity", "position"): -sin @ (weight * omega),
            ("velocity", "force"): -sin @ (weight * omega * force),
        }

    def of(self, first: str, second: str, lag: Array) -> Array:
        """Return the covariance of `first` with `second` `lag` steps before it, shape of `lag`."""
        if (first, second) in self.even:
            return np.asarray(self.even[first, second][np.abs(lag)])
        return np.asarray(np.sign(lag) * self.odd[first, second][np.abs(lag)])


def main():
    """Run the schemes, compute the bounds, and write both."""
    folder, replicates, overrides = read_words("results/better", 100)
    run = owtsweep.run(["experiment=better", f"grid.replicates={replicates}", *overrides])
    bounds = compute_bounds(run.config)
    checked = check_bounds(run.config, bounds)

    def draw():
        figure = efficiency.draw(run.config, run.summary())
        style.add_origin(figure, describe_origin(run.config))
        return figure

    tables = {"efficiency": make_table(run, bounds), "bounds": checked}
    write(folder, tables, {"efficiency": draw}, run.metadata())
    apart = np.abs(checked["recursion"] / checked["window"] - 1.0).max()
    print(f"The two ways to bound (b) differ by at most {100.0 * apart:.2f} %.")


if __name__ == "__main__":
    main()
