"""Which settings does the print fix? Widths, directions and profiles of the posterior."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import pandas as pd
from scipy.optimize import minimize

from experiments.ren2019.posterior.evidence import Posterior
from experiments.ren2019.posterior.likelihood import Likelihood
from experiments.ren2019.posterior.settings import NAMES, SETTINGS, from_unit
from owtsweep.arrays import Array

#: Standard deviation of a uniform distribution of width 1.
UNIFORM = 12.0**-0.5


def tabulate_widths(posterior: Posterior) -> pd.DataFrame:
    """Return one row per setting: prior, posterior's median and 95 %, its sd over the prior's.

    above: probability of the upper half of the prior, in the logarithm; half without the print.
    """
    units = posterior.points[:, : len(NAMES)]
    low, middle, high = from_unit(np.quantile(units, [0.025, 0.5, 0.975], axis=0))
    best = from_unit(posterior.best[: len(NAMES)])
    return pd.DataFrame(
        {
            "setting": NAMES,
            "unit": [setting.unit for setting in SETTINGS],
            "prior_low": [setting.low for setting in SETTINGS],
            "prior_high": [setting.high for setting in SETTINGS],
            "low": low,
            "median": middle,
            "high": high,
            "mode": best,
            "width": units.std(axis=0) / UNIFORM,
            "above": (units > 0.5).mean(axis=0),
        }
    )


def find_directions(likelihood: Likelihood, points: Array) -> tuple[Array, Array]:
    """Return eigenvalues (n,) and eigenvectors (n, settings) of the averaged Fisher information.

    In units of the priors' standard deviations: an eigenvalue above 1 is a direction that the print
    fixes better than the prior. Largest first. Means and discrepancies' scales are as predicted.
    """
    total = np.zeros((len(NAMES), len(NAMES)))
    for point in points:
        _, variances = likelihood.predict(point)
        solved = np.linalg.inv(likelihood.covariance(point, variances))
        slopes = np.empty((len(NAMES), 64))
        for place in range(len(NAMES)):
            ends = np.tile(point, (2, 1))
            ends[:, place] = np.clip(point[place] + np.array([-0.01, 0.01]), 0.0, 1.0)
            change = likelihood.predict(ends[1])[0] - likelihood.predict(ends[0])[0]
            slopes[place] = change / (ends[1, place] - ends[0, place]) * UNIFORM
        total += slopes @ solved @ slopes.T
    values, vectors = np.linalg.eigh(total / len(points))
    return values[::-1], vectors.T[::-1]


def find_profile(
    likelihood: Likelihood, posterior: Posterior, name: str, steps: int = 9
) -> pd.DataFrame:
    """Return the greatest likelihood at each value of a setting; all others are searched.

    Columns setting, value, log_likelihood (below the greatest of all).
    """
    place, rows = NAMES.index(name), []
    points, likelihoods = posterior.points, posterior.likelihoods
    edges = np.linspace(0.0, 1.0, steps + 1)
    for left, right in pairwise(edges):
        middle = 0.5 * (left + right)
        near = np.argsort(np.abs(points[:, place] - middle) * 20.0 - likelihoods)[0]
        start = points[near].copy()
        start[place] = middle
        free = np.arange(len(start)) != place

        def cost(some: Array, start: Array = start, free: Array = free) -> float:
            point = start.copy()
            point[free] = np.clip(some, 1e-3, 1.0 - 1e-3)
            return -likelihood(point)

        found = minimize(cost, start[free], method="Powell", options={"maxiter": 3})
        value = from_unit(np.full(len(NAMES), middle))[place]
        rows.append({"setting": name, "value": value, "log_likelihood": -float(found.fun)})
    table = pd.DataFrame(rows)
    best = max(float(table["log_likelihood"].max()), float(likelihoods.max()))
    return table.assign(log_likelihood=table["log_likelihood"] - best)
