"""Searches the numbers of a scheme, with the same number of trials for each scheme.

Trials of a scheme with curves are judged by its expected errors. A scheme without curves (HME2 with
constraints) is judged by a few short records; all its trials see the same ones.
"""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from operator import attrgetter

from owtsweep.config import Plain, changed, with_values
from owtsweep.studies.base import searching
from owtsweep.studies.base.searching import Space, Trial, attempt
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.tuning.errors import (
    DURATION,
    SETTLING,
    errors_on_records,
    expected_errors,
    has_curves,
    score,
)
from owtsweep.studies.hub.tuning_rules import compute_numbers, take_facts

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
