"""Runs whose schemes have known errors, for the tests of the fidelity report."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping
from functools import cache

import numpy as np
import pandas as pd

from experiments.ren2019 import reasons
from experiments.ren2019.evidence import AMPLITUDES, PERIODS, SCHEMES, Evidence
from experiments.ren2019.published import published_numbers
from owtsweep.studies.hub.worlds import CONDITIONS
from owtsweep.verdicts.score_table import ScoreTable

REPLICATES = 6
EVERYTHING = ("x", "y", "vx", "vy", "position", "velocity", "nees", "nis")
#: (noise floor F, motion coefficient A) of a scheme's MSE F + N^2 A.
Terms = tuple[float, float]
ALIKE: dict[str, Terms] = {"EKF": (9.0, 9.0), "MKF": (9.0, 9.0), "HME1": (2.0, 0.01)}


def world(
    terms: Mapping[str, Terms] | Callable[[str, float], Mapping[str, Terms]],
    *,
    measures=("position", "velocity"),
    wobble: Mapping[str, float] | None = None,
    periods=PERIODS,
    amplitudes=AMPLITUDES,
    schemes=SCHEMES,
) -> Evidence:
    """A run whose schemes have these terms, by scheme or by (measure, natural period).

    All records differ a little, by a factor that the schemes share. `wobble` moves a scheme's
    records up and down by that part without moving their mean.
    """
    replicate = np.arange(REPLICATES)
    shared = 1.0 + 0.01 * (replicate - replicate.mean())
    up_and_down = np.where(replicate % 2, 1.0, -1.0)
    up_and_down = up_and_down - np.mean(up_and_down * shared) / np.mean(shared)
    rows = []
    for measure, period, scheme in itertools.product(measures, periods, schemes):
        known = terms(measure, period) if callable(terms) else terms
        F, A = known[scheme]
        factor = shared * (1.0 + (wobble or {}).get(scheme, 0.0) * up_and_down)
        for (window, samples), r in itertools.product(
            {"full": 400, "settled": 300}.items(), replicate
        ):
            row = {"natural_period": period, "replicate": r, "scheme": scheme, "measure": measure}
            row |= {"window": window, "amplitude": np.nan, "motion": A * factor[r], "cross": 0.0}
            row |= {"noise": F * factor[r], "value": np.nan, "n_samples": samples}
            rows.append(row | {"status": "ok", "reason": ""})
    return make_evidence(pd.DataFrame(rows), schemes, periods, amplitudes)


def make_evidence(
    rows: pd.DataFrame,
    schemes=SCHEMES,
    periods=PERIODS,
    amplitudes=AMPLITUDES,
) -> Evidence:
    """The evidence of these rows in the full window."""
    grid = {"natural_period": tuple(periods), "amplitude": tuple(amplitudes)}
    return Evidence(
        rows=rows,
        schemes=tuple(schemes),
        scores=ScoreTable.of_rows(rows, CONDITIONS, grid, "full"),
        window="full",
    )


def hme2_beyond(boundary: float, **others: Terms) -> dict[str, Terms]:
    """A world in which HME2 is best below that amplitude and HME1 above."""
    return {**ALIKE, **others, "HME2": (1.0, 1.0 / boundary**2 + 0.01)}


PRINTED = published_numbers().set_index(["natural_period", "amplitude", "scheme", "measure"])[
    "published"
]


@cache
def printed(measure: str, period: float) -> dict[str, Terms]:
    """A world that gives all 64 numbers back."""
    parts = {"position": ("x", "y"), "velocity": ("vx", "vy")}.get(measure, (measure,))
    result = {}
    for scheme in SCHEMES:
        F = sum(
            reasons.implied_floor(scheme, part) for part in parts if part in ("x", "y", "vx", "vy")
        )
        N = {3.0: 2.0, 4.0: 0.2, 8.0: 1.0}.get(period)
        if N is None or measure in ("nees", "nis"):
            result[scheme] = (1.0, 1.0)
        else:
            total = sum(PRINTED[period, N, scheme, part] for part in parts)
            result[scheme] = (F, (total - F) / N**2)
    return result


EQUAL: dict[str, Terms] = dict.fromkeys(SCHEMES, (2.0, 0.01))
BEST_EKF = {**dict.fromkeys(SCHEMES, (5.0, 1e-3)), "EKF": (0.1, 1e3)}


def mkf_at_two_cells(measure: str, period: float) -> dict[str, Terms]:
    mkf = (1.6, 1.5) if period in (4.0, 5.0) else (5.0, 1.5)
    return {"EKF": (10.0, 1.0), "MKF": mkf, "HME1": (2.0, 1e-3), "HME2": (1.0, 4.0)}


def mkf_far_from_hme1(measure: str, period: float) -> dict[str, Terms]:
    return {**mkf_at_two_cells(measure, period), "EKF": (2.1, 1e-3), "HME1": (9.0, 1.0)}


def growing(measure: str, period: float) -> dict[str, Terms]:
    return hme2_beyond(0.3 * (period / 4.0) ** 2)


def shrinking(measure: str, period: float) -> dict[str, Terms]:
    return hme2_beyond(0.3 * (4.0 / period) ** 2)


@cache
def scattered_world() -> Evidence:
    """Random products, so that every number can be checked by hand."""
    terms = {s: (1e-3 * (i + 1), 1e-3) for i, s in enumerate(SCHEMES)}
    evidence = world(terms, measures=EVERYTHING)
    rng = np.random.default_rng(1)
    rows = evidence.rows.copy()
    for name in ("motion", "noise"):
        rows[name] *= rng.uniform(0.5, 2.0, len(rows))
    rows["cross"] = rng.normal(0.0, 1e-4, len(rows))
    rows.loc[3, "status"] = "failed"
    return make_evidence(rows)
