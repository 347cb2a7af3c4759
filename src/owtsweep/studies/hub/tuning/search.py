"""Searches the numbers of a scheme, with the same number of trials for each scheme.

Trials are judged by settled errors over periods and amplitudes. Those of a scheme with curves are
expected errors (`studies.hub.expected`), which need no record, so no random number decides between
two tunings. A scheme without curves (HME2 with constraints) is judged by a few short records; all
its trials see the same ones.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import partial
from itertools import groupby
from operator import attrgetter

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.config import Plain, changed, with_values
from owtsweep.errors import InputError
from owtsweep.results.superposition import superpose
from owtsweep.studies.base import searching
from owtsweep.studies.base.blocks import DeclaredBlocks
from owtsweep.studies.base.searching import Space, Trial, attempt
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, Scheme, resolve
from owtsweep.studies.hub.describe import make_cube
from owtsweep.studies.hub.engines import find_declaration
from owtsweep.studies.hub.error_curves.curves import curves
from owtsweep.studies.hub.error_curves.of_schemes import motion_of, noise_of
from owtsweep.studies.hub.tuning_rules import compute_numbers, take_facts

#: Length of the records of whose settled part the errors are the mean, and the part left out, s. A
#: tuning is judged by how an estimator runs on, not by how it starts: the bias takes up to 100 s.
DURATION = 300.0
SETTLING = 100.0
#: Name of that part in the rows of a run.
WINDOW = "settled"
#: Number of amplitudes between the ends of the range that is tuned for.
AMPLITUDES = 7


def amplitudes(config: HubConfig) -> Array:
    """Return the amplitudes that a tuning is judged at, m: the range's ends and five between."""
    low, high = config.tune.amplitude or (min(config.grid.amplitude), max(config.grid.amplitude))
    return np.geomspace(low, high, AMPLITUDES) if high > low else np.array([low])


def has_curves(scheme: Scheme) -> bool:
    return scheme.linear and scheme.batched == "chain"


def expected_errors(config: HubConfig, scheme: Scheme) -> Array:
    """Compute a scheme's settled MSE, m^2 or (m/s)^2, shape (periods, amplitudes).

    Raises ValueError or ArithmeticError if the scheme cannot be computed with this tuning.
    """
    sensors = sensing.sensors(config.sensors)
    steps, settled = (round(seconds / sensors.step) for seconds in (DURATION, SETTLING))
    chain = scheme.kernel(Known(sensors, config), steps)
    curve = curves(chain, sensors, steps=steps, settled=settled, band=config.band)
    measure, shares = _parts(config)
    motion = motion_of(config, curve, config.grid.natural_period)[:, measure, 1]
    noise = noise_of(config, sensors, curve)[:, measure, 1]
    cells = [
        superpose(share * motion[:, None], 0.0, floor, amplitudes(config))
        for share, floor in zip(shares, noise, strict=True)
        if share is not None
    ]
    return np.asarray(np.sum(cells, axis=0))


def _parts(config: HubConfig) -> tuple[int, tuple[float | None, float | None]]:
    """Return the criterion's index, and each axis' share of the motion; None if it is left out."""
    angle = np.deg2rad(config.wave_direction)
    x, y = float(np.cos(angle) ** 2), float(np.sin(angle) ** 2)
    criterion = config.measures.criterion
    shares = {"x": (x, None), "y": (None, y)}.get(criterion, (x, y))
    return int(criterion == "velocity"), shares


def errors_on_records(config: HubConfig, schemes: Sequence[str], replicates: int) -> Array:
    """Run schemes on records; return their settled MSE by `measures.criterion`.

    The shape is (schemes, periods, amplitudes, replicates). Raises InputError if a case fails.
    """
    entries = [entry for entry in config.schemes if resolve(entry).name in schemes]
    grid = changed(config.grid, amplitude=amplitudes(config).tolist(), replicates=replicates)
    part = changed(config, engine="batch", grid=grid, schemes=entries, baselines=[])
    blocks, rows = DeclaredBlocks(find_declaration(part)), []
    for _, group in groupby(blocks.plan(part), attrgetter("group")):
        rows += [table for _, table in blocks.run(part, list(group))]
    cube = make_cube(part, pd.concat(rows, ignore_index=True))
    place = (cube.measures.index(part.measures.criterion), cube.windows.index(WINDOW))
    numbers = [cube.schemes.index(name) for name in schemes]
    errors = np.array(
        [[cube.values(i, outer)[:, *place] for outer in cube.outer_places()] for i in numbers]
    )
    if not np.all(np.isfinite(errors)):
        raise InputError("tuning: a scheme's estimates on the records are not finite; try another")
    return errors


def score(errors: Array) -> float:
    """Return the geometric mean of the errors of all cells, in their unit; NaN if one is.

    The geometric mean weighs a percent less the same in each cell, whatever the cell's error.
    """
    with np.errstate(all="ignore"):
        return float(np.exp(np.mean(np.log(errors))))


#: Bounds of a filter's q_a, (m/s^3)^2/Hz, and of the factor on the variance of HME2's positions.
NOISE = (1e-3, 1e4)
SCALE = (1e-3, 1e3)
#: Longest smoother window, s, and longest window of the MHE, in GNSS intervals.
LONGEST_WINDOW = 1.0
LONGEST_HORIZON = 40
#: The MHE takes at most this many values of T_m: the longest of those that are allowed.
INTERVALS = 5

#: The structure of HME2's MHE in `tuning=matched`, the fullest that there is.
STRUCTURE = {"hme.mhe.arrival": "mkf", "hme.mhe.inputs": "all", "hme.mhe.weights": "full"}


def find_space(config: HubConfig, scheme: str) -> Space:
    """Return the keys to search for a scheme, with their bounds; none for an unknown scheme."""
    imu, gnss = config.sensors.imu, config.sensors.gnss
    window = [0, round(LONGEST_WINDOW * imu.rate), "int"]
    spaces: dict[str, Space] = {
        "EKF": {"ekf.q_a": [*NOISE, "log"]},
        "MKF": {"mkf.q_a": [*NOISE, "log"]},
        "HME1": {"hme1.q_a": [*NOISE, "log"], "hme.smoother_window": window},
        "HME2": {
            "hme2.q_a": [*NOISE, "log"],
            "hme2.r_gnss.scale": [*SCALE, "log"],
            "hme.mhe.smoother_window": window,
            "hme.mhe.horizon": [1, LONGEST_HORIZON, "int"],
            "hme.mhe.interval": {"options": _list_intervals(imu.rate, gnss.rate)},
            "hme.mhe.arrival": {"options": ["mkf", "fixed", "none"]},
            "hme.mhe.inputs": {"options": ["all", "averaged", "sampled"]},
            "hme.mhe.weights": {"options": ["full", "diagonal"]},
        },
    }
    return spaces.get(scheme, {})


def _list_intervals(imu_rate: float, gnss_rate: float) -> list[float]:
    """Return the longest allowed T_m, s: whole IMU steps that divide the GNSS interval."""
    M = round(imu_rate / gnss_rate)
    steps = [n for n in range(M, 0, -1) if M % n == 0]
    return [n / imu_rate for n in steps[:INTERVALS]]


#: Computing time of a trial by expected errors for each natural period, s, on one core of a server
#: of 2026: at six periods .2 s for EKF and MKF, .4 for HME1 and .5 for HME2.
SECONDS = 0.055
#: Number of records per natural period on which a scheme without curves is judged.
TRAINING_RECORDS = 2


def search(config: HubConfig, scheme: Scheme) -> Iterator[Trial]:
    """Search the best numbers of one scheme; yield each trial, first the tuning to begin with.

    The same configuration gives the same trials: every random number comes from `tune.seed`.
    """
    objective = partial(_judge, _make_training(config, scheme), scheme)
    yield attempt(objective, {})
    yield from searching.search(
        find_space(config, scheme.name), objective,
        trials=config.tune.trials, seed=config.tune.seed, starts=_list_starts(config, scheme),
    )  # fmt: skip


def _list_starts(config: HubConfig, scheme: Scheme) -> list[Plain]:
    """Return the first trials: the tuning to begin with, and the rules of `tuning=matched`."""
    current = {key: attrgetter(key)(config) for key in find_space(config, scheme.name)}
    return [current, {**STRUCTURE, **compute_numbers(take_facts(config.sensors))}]


def _make_training(config: HubConfig, scheme: Scheme) -> HubConfig:
    """Return the configuration of the trials: with another seed than the runs that judge later."""
    training = changed(config, seed=config.tune.seed)
    if has_curves(scheme):
        return training
    return changed(
        training,
        record=changed(config.record, duration=min(DURATION, config.record.duration)),
        measures=changed(config.measures, settling_time=SETTLING),
    )


def _judge(config: HubConfig, scheme: Scheme, values: Plain) -> float:
    tuned = with_values(config, values)
    if has_curves(scheme):
        return score(expected_errors(tuned, scheme))
    (errors,) = errors_on_records(tuned, [scheme.name], TRAINING_RECORDS)
    return score(errors.mean(axis=-1))
