"""One record of a study with everything in it: truth, measurements, estimates, covariances."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

from owtsweep.arrays import Array


class Reading(NamedTuple):
    """What one sensor says of a record.

    Attributes
    ----------
    time
        The times of arrival, or those that the sensor's own clock shows, in s, shape (n,).
    value
        The measurements, shape (n, ...); NaN where one was lost.
    """

    time: Array
    value: Array


@dataclass(frozen=True)
class EstimatedRecord:
    """One record of a study: what was true, what sensors said, and what schemes made of it.

    Each study names its own quantities. `truth` and the estimates of a scheme share these names, so
    that `record.estimates["MEKF"]["root"] - record.truth["root"]` is an error.

    Attributes
    ----------
    study, tuning
        Names of the study and of the tuning.
    conditions
        The cell of the grid: condition -> value.
    replicate
        Number of the record.
    settled
        Number of the first sample that the study judges.
    time
        Times of the samples in s, shape (steps,).
    truth
        Quantity -> true values, shape (steps, ...).
    measurements
        Name of a sensor's signal -> its times and values.
    estimates
        Scheme -> quantity -> estimated values, shape (steps, ...).
    covariances
        Scheme -> quantity -> covariance of the error, shape (steps, n, n). A quantity that is
        missing here has none.
    waits
        Scheme -> time in s that a user waits for an estimate; 0 for what runs in real time.
    units
        Unit of each quantity and of each signal, and its frame where this needs saying.
    failures
        Scheme that gave no estimates -> the reason.
    at_rest
        Quantity -> its value while nothing moves, where that is not zero.
    """

    study: str
    tuning: str
    conditions: Mapping[str, float | str]
    replicate: int
    settled: int
    time: Array
    truth: Mapping[str, Array]
    measurements: Mapping[str, Reading]
    estimates: Mapping[str, Mapping[str, Array]]
    covariances: Mapping[str, Mapping[str, Array]]
    waits: Mapping[str, float]
    units: Mapping[str, str]
    failures: Mapping[str, str]
    at_rest: Mapping[str, Array] = field(default_factory=dict)
