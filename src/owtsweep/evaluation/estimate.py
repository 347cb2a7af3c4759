"""What estimators say: an estimate at one step, and all that schemes make of one record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

from owtsweep.arrays import Array


class Innovation(NamedTuple):
    """A measurement minus its prediction: value, shape (m,), and its covariance, shape (m, m).

    Units are those of the measurement.

    >>> import numpy as np
    >>> innovation = Innovation(np.array([0.02, -0.01]), 0.03**2 * np.eye(2))  # m and m^2
    >>> nis = innovation.value @ np.linalg.solve(innovation.covariance, innovation.value)
    >>> round(float(nis), 3)
    0.556
    """

    value: Array
    covariance: Array


class Estimate:
    """An estimator's estimate of the present state: what `update` returns at each step.

    A study defines which quantities are judged, and the dimension and unit of each. The hub study,
    for example, judges position (m) and velocity (m/s), each of shape (2,), north and east:
    `Estimate(position, velocity)`. Other quantities are given by name, as in `Estimate(angle=...,
    strain=...)`. Each becomes an attribute of its name.

    covariance: Covariance (n, n) of the errors of all judged quantities, one after the other in the
        study's order. From it the study computes NEES, the normalised estimation error squared.
    innovation: the innovation of this step's measurement. From it the study computes NIS, the
        normalised innovation squared.
    quantities: Name -> value of all quantities that were given.

    >>> import numpy as np
    >>> estimate = Estimate(np.array([0.3, 0.1]), np.zeros(2), covariance=0.01 * np.eye(4))
    >>> estimate.position
    array([0.3, 0.1])
    """

    __slots__ = ("covariance", "innovation", "quantities")
    quantities: Mapping[str, Array]

    def __init__(
        self,
        position: Array | None = None,
        velocity: Array | None = None,
        covariance: Array | None = None,
        innovation: Innovation | None = None,
        **quantities: Array,
    ) -> None:
        usual = {"position": position, "velocity": velocity}
        self.quantities = {k: value for k, value in usual.items() if value is not None} | quantities
        self.covariance = covariance
        self.innovation = innovation

    def __getattr__(self, name: str) -> Array:
        # during unpickling `quantities` does not exist yet
        if name != "quantities" and name in self.quantities:
            return self.quantities[name]
        raise AttributeError(f"the estimate has no {name}")

    def __repr__(self) -> str:
        further = {"covariance": self.covariance, "innovation": self.innovation}
        said = ", ".join(f"{k}={v!r}" for k, v in {**self.quantities, **further}.items())
        return f"Estimate({said})"

    def _replace(self, **changes: Any) -> Estimate:
        kept = {"covariance": self.covariance, "innovation": self.innovation}
        return Estimate(**{**self.quantities, **kept, **changes})


class Reading(NamedTuple):
    """What one sensor says of a record: times (n,) in s, and values (n, ...), NaN if lost.

    Times are those of arrival, or those that the sensor's own clock shows.

    >>> import numpy as np
    >>> fixes = Reading(np.array([0.0, 1.0]), np.array([[0.1, 0.0], [np.nan, np.nan]]))
    >>> fixes.time[np.isnan(fixes.value).any(axis=1)]  # lost
    array([1.])
    """

    time: Array
    value: Array


@dataclass(frozen=True)
class EstimatedRecord:
    """One record of a study: what was true, what sensors said, and what schemes made of it.

    Each study names its own quantities. `truth` and the estimates of a scheme share these names, so
    that `record.estimates["MEKF"]["root"] - record.truth["root"]` is an error.

    study, tuning: names of the study and of the tuning.
    conditions: the cell of the grid: condition -> value.
    replicate: Number of the record.
    settled: Number of the first sample that the study judges.
    time: Times of the samples in s, shape (steps,).
    truth: Quantity -> true values, shape (steps, ...).
    measurements: Name of a sensor's signal -> its times and values.
    estimates: Scheme -> quantity -> estimated values, shape (steps, ...).
    covariances: Scheme -> quantity -> covariance of the error, shape (steps, n, n). A quantity that
        is missing here has none.
    latencies: Scheme -> latency in s; 0 for what runs in real time.
    units: Unit of each quantity and of each signal, and its frame where this needs saying.
    failures: Scheme that gave no estimates -> the reason.
    at_rest: Quantity -> its value while nothing moves, where that is not zero.

    >>> import numpy as np, owtsweep
    >>> record = owtsweep.estimate([
    ...     "study=floater", "grid.delay=[0]", "grid.bias=[0]", "schemes=[KF_REPAIRED]",
    ... ])
    >>> judged = slice(record.settled, None)
    >>> spread = record.covariances["KF_REPAIRED"]["position"][judged, 0, 0] ** 0.5
    >>> error = record.estimates["KF_REPAIRED"]["position"] - record.truth["position"]
    >>> bool(np.std(error[judged, 0]) < 3 * spread.mean())
    True
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
    latencies: Mapping[str, float]
    units: Mapping[str, str]
    failures: Mapping[str, str]
    at_rest: Mapping[str, Array] = field(default_factory=dict)
