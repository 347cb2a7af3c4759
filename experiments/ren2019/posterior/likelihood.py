"""The likelihood of the 64 printed numbers, taken as those of one record."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np
from scipy.linalg import solve_triangular
from scipy.special import ndtri

from experiments.ren2019.evidence import SCHEMES, TABLE_CELLS
from experiments.ren2019.posterior import emulator
from experiments.ren2019.posterior.components import PERIODS, Components
from experiments.ren2019.posterior.emulator import Emulator
from experiments.ren2019.posterior.records import Scatter, log_student, print_of_tables
from experiments.ren2019.posterior.settings import (
    ACCURACIES,
    DISCREPANCY,
    FIX_VARIANCE,
    IMU_VARIANCE,
    LENGTHS,
    MOTIONS,
    NAMES,
    Reading,
    columns_of,
    from_unit,
)
from owtsweep.arrays import Array

#: Places of bias_walk and bias_initial among the settings.
_WALK, _INITIAL = NAMES.index("bias_walk"), NAMES.index("bias_initial")
#: Places among `PERIODS` of the tables' cells, shape (4,).
_ROWS = np.array([PERIODS.index(cell.natural_period) for cell in TABLE_CELLS.values()])
#: Square of the motion along x and y per square along the wave, which comes 30 deg from x; times
#: that of the cells' amplitudes, shape (4, 1, 2).
_ALONG = np.array([[[0.75, 0.25]]]) * np.array(
    [[[cell.amplitude**2]] for cell in TABLE_CELLS.values()]
)
#: Mean over records of the emulator's tables: eight, so that a mean scatters by this share more.
_MEANS = 1.0 / 8.0


def fit_emulators(
    tables: Mapping[str, tuple[Array, Components]], reading: Reading, hyper: dict[str, Array]
) -> dict[str, Emulator]:
    """Fit an emulator of each scheme's components under a reading.

    Outputs are logarithms: motion (periods, 2), then noise (sources, 2), position and velocity.
    hyper: scheme -> hyperparameters; those that are missing are searched and added.
    """
    motion_of = MOTIONS.index((reading.force, reading.spectrum))
    length = LENGTHS.index(reading.length)
    window, fitted = 0 if reading.start else 1, {}
    for scheme, (points, parts) in tables.items():
        motion = parts.motion[:, motion_of, :, length, window].reshape(len(points), -1)
        noise = parts.noise[:, :, length, window].reshape(len(points), -1)
        outputs = np.log(np.maximum(np.hstack([motion, noise]), 1e-30))
        fitted[scheme], hyper[scheme] = emulator.fit(points, outputs, hyper.get(scheme))
    return fitted


@dataclass
class Likelihood:
    """The likelihood of the print under a reading; a point is a place in the unit cube.

    A point has the settings, then the four discrepancies' scales. The discrepancy of a scheme is
    normal in the logarithm, equal in x and y of a table, independent otherwise.

    used: which of the 64 numbers count, shape (64,).
    discrepant: whether schemes have a discrepancy. Without one, the last four do not matter.
    part: how much of the priors' widths counts, about their middles in the logarithm.
    """

    reading: Reading
    emulators: Mapping[str, Emulator]
    scatter: Scatter
    used: Array = field(default_factory=lambda: np.ones(64, dtype=bool))
    discrepant: bool = True
    part: float = 1.0

    def __post_init__(self) -> None:
        print_ = print_of_tables()
        self.logs = np.log(print_["published"].to_numpy(dtype=float))
        self.fixed = self.scatter.covariance * (1.0 + _MEANS) + np.diag(print_["rounding"])
        self.pairs = np.kron(np.eye(32), np.ones((2, 2)))  # x and y of a number
        self.scheme = np.array([SCHEMES.index(scheme) for scheme in print_["scheme"]])

    @property
    def dimensions(self) -> int:
        return len(NAMES) + len(SCHEMES)

    def settings(self, point: Array) -> Array:
        """Return the settings of a point as places in their whole priors, shape (settings,)."""
        return 0.5 + self.part * (point[: len(NAMES)] - 0.5)

    def scales(self, point: Array) -> Array:
        """Return the scales of the schemes' discrepancies, shape (4,), by a half-normal prior."""
        if not self.discrepant:
            return np.zeros(len(SCHEMES))
        part = np.clip(point[len(NAMES) :], 1e-9, 1.0 - 1e-9)
        return np.asarray(DISCREPANCY * ndtri(0.5 + 0.5 * part))

    def predict(self, point: Array) -> tuple[Array, Array]:
        """Return means (64,) of the logarithms of one record, and the emulators' variances."""
        unit = self.settings(point)
        values = from_unit(unit)
        share = ACCURACIES[self.reading.accuracy] ** 2
        of_bias = values[[_WALK, _INITIAL]] ** 2
        sizes = np.array([share * FIX_VARIANCE, share * IMU_VARIANCE, *of_bias])
        means, variances = np.empty((4, 4, 2, 2)), np.empty((4, 4, 2, 2))
        for place, scheme in enumerate(SCHEMES):
            fitted = self.emulators[scheme]
            parts = np.exp(fitted.predict(unit[columns_of(scheme)])).reshape(-1, 2)
            errors = fitted.error.reshape(-1, 2) ** 2
            motion = _ALONG * parts[_ROWS][:, :, None]
            noise = sizes[:, None] * parts[len(PERIODS) :]
            total = motion + noise.sum(axis=0)[:, None]
            of_noise = np.sum(noise**2 * errors[len(PERIODS) :], axis=0)[:, None]
            means[:, place] = total
            variances[:, place] = (motion**2 * errors[_ROWS][:, :, None] + of_noise) / total**2
        # (table, scheme, position or velocity, axis) is the order of the print
        return np.log(means).ravel() + self.scatter.offset, variances.ravel()

    def covariance(self, point: Array, variances: Array) -> Array:
        """Return the covariance of one record's logarithms about the prediction, (64, 64)."""
        added = self.scales(point)[self.scheme] ** 2 + variances
        return np.asarray(self.fixed + self.pairs * np.sqrt(added[:, None] * added))

    def __call__(self, point: Array) -> float:
        """Return the logarithm of the likelihood at a point."""
        mean, variances = self.predict(point)
        used = self.used
        matrix = self.covariance(point, variances)[np.ix_(used, used)]
        factor = np.linalg.cholesky(matrix)
        solved = solve_triangular(factor, (self.logs - mean)[used], lower=True)
        size = int(used.sum())
        density = log_student(np.asarray(solved @ solved), size, self.scatter.freedom)
        return float(density - np.log(np.diag(factor)).sum())
