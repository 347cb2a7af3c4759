"""Searches the numbers of each scheme with Optuna, with the same number of trials for each scheme.

Trials of a scheme with curves are judged by its expected errors. A scheme without curves (HME2 with
constraints) is judged by a few short records; all its trials see the same ones.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from operator import attrgetter
from typing import Any

import numpy as np

from owtsweep.config import Plain, changed, with_values
from owtsweep.errors import InputError
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.tuning.judging import errors_on_records
from owtsweep.studies.hub.tuning.objective import (
    DURATION,
    SETTLING,
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

#: [low, high, "log" or "int"], or the list of options.
Space = Plain


def find_space(config: HubConfig, scheme: str) -> Space:
    """Return key -> its bounds or options, for the numbers of a scheme; {} for an unknown scheme.

    A key has the bounds [low, high, "log"] or [low, high, "int"], or a mapping with its `options`.
    """
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
            "hme.mhe.interval": {"options": list_intervals(imu.rate, gnss.rate)},
            "hme.mhe.arrival": {"options": ["mkf", "fixed", "none"]},
            "hme.mhe.inputs": {"options": ["all", "averaged", "sampled"]},
            "hme.mhe.weights": {"options": ["full", "diagonal"]},
        },
    }
    return spaces.get(scheme, {})


def list_intervals(imu_rate: float, gnss_rate: float) -> list[float]:
    """Return the longest allowed values of T_m, s: whole IMU steps that divide the GNSS interval.

    The rates are in Hz.
    """
    M = round(imu_rate / gnss_rate)
    steps = [n for n in range(M, 0, -1) if M % n == 0]
    return [n / imu_rate for n in steps[:INTERVALS]]


#: Number of records per natural period on which a scheme without curves is judged.
TRAINING_RECORDS = 2
#: The score of a trial that cannot be computed or diverges, in units of the score at the start.
HOPELESS = 1e3


@dataclass(frozen=True)
class Found:
    """The best numbers that a search has found for one scheme.

    Attributes
    ----------
    values
        Key -> value; empty if no trial was better than the tuning that the search began with.
    before, after
        The score of that tuning, and the best score.
    trials
        Number of trials made; fewer than planned if the user stopped the search.
    """

    values: Plain
    before: float
    after: float
    trials: int


def search(config: HubConfig, scheme: Scheme, advance: Callable[[], None]) -> tuple[Found, bool]:
    """Search the best numbers of one scheme; return them, and whether the user stopped the search.

    The same configuration gives the same numbers: every random number comes from `tune.seed`.

    Parameters
    ----------
    config
        The configuration with the tuning to begin with.
    scheme
        The scheme.
    advance
        Called after each trial.
    """
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    training = _make_training(config, scheme)
    space = find_space(config, scheme.name)
    sampler = optuna.samplers.TPESampler(seed=config.tune.seed, multivariate=True)
    study = optuna.create_study(sampler=sampler)
    for start in _list_starts(config, space):
        study.enqueue_trial(start)
    best: Plain = {}
    least, made, before = float("inf"), 0, float("inf")
    stopped = False
    try:
        before = least = _judge(training, scheme, {})
        for _ in range(config.tune.trials):
            trial = study.ask()
            values = {key: _suggest(trial, key, bounds) for key, bounds in space.items()}
            value = _judge(training, scheme, values)
            study.tell(trial, float(np.log(min(value / before, HOPELESS))))
            made += 1
            if value < least:
                least, best = value, values
            advance()
    except KeyboardInterrupt:
        stopped = True
    return Found(best, before, least, made), stopped


def _list_starts(config: HubConfig, space: Space) -> list[Plain]:
    """Return the first trials: the tuning to begin with, and the rules of `tuning=matched`.

    Of each, only the values within their bounds are kept. If both are equal, there is one.
    """
    current = {key: attrgetter(key)(config) for key in space}
    imu = config.sensors.imu
    ruled = {**STRUCTURE, **compute_numbers(take_facts(config.sensors), imu.bias_walk)}
    starts = [
        {key: start[key] for key in space if _is_within(start[key], space[key])}
        for start in (current, ruled)
    ]
    return starts[:1] if starts[0] == starts[1] else starts


def _is_within(value: Any, bounds: Any) -> bool:
    if isinstance(bounds, Mapping):
        return value in bounds["options"]
    return value is not None and bool(bounds[0] <= value <= bounds[1])


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
    """Compute the score of a tuning; infinite if the scheme cannot be computed with it."""
    try:
        tuned = with_values(config, values)
        if has_curves(scheme):
            return score(expected_errors(tuned, scheme))
        return score(errors_on_records(tuned, [scheme.name], TRAINING_RECORDS)[0].mean(axis=-1))
    except (InputError, ArithmeticError, ValueError):  # LinAlgError is a ValueError
        return float("inf")


def _suggest(trial: Any, key: str, bounds: Any) -> Any:
    if isinstance(bounds, Mapping):
        return trial.suggest_categorical(key, list(bounds["options"]))
    low, high, scale = bounds
    if scale == "int":
        return trial.suggest_int(key, low, high)
    return trial.suggest_float(key, low, high, log=True)
