"""Runs all scenarios on several records and collects their scores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import pandas as pd
from joblib import delayed

from experiments.maes2018 import scores
from experiments.maes2018.scenarios import COASTING, REFERENCE, Record, compose_cell, simulate
from experiments.parallel import compute


class Scenario(NamedTuple):
    """Overrides of the paper's system, the schemes that run, and what is measured of each."""

    words: tuple[str, ...]
    schemes: tuple[str, ...]
    measure: Callable[[Record, str], dict[str, float]]


SCENARIOS = {
    **{
        name: Scenario(words, ("SMOOTHER",), scores.score_reference)
        for name, words in REFERENCE.items()
    },
    "filters": Scenario((), scores.FILTERS, scores.score_filter),
    "coasting": Scenario(COASTING, ("UKF",), scores.score_coasting),
    "boom": Scenario((), ("DOUBLE_INTEGRATION",), lambda record, _: scores.score_boom(record)),
    "geometry": Scenario((), ("none",), lambda record, _: scores.score_geometry(record.replicate)),
}


def collect(replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Run all scenarios; return their scores, as `score` does.

    Records have the numbers `replicates`. Scenarios run side by side, in as many processes as there
    are cores.
    """
    jobs = {f"{name}: judged": delayed(score)(name, replicates, overrides) for name in SCENARIOS}
    return pd.concat(compute(jobs), ignore_index=True)


def score(name: str, replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Return the scores of a scenario on records.

    Columns: scenario, scheme ("none" where none runs), measure, replicate, value.
    """
    words, schemes, measure = SCENARIOS[name]
    config = compose_cell([*words, *overrides])  # once, not per record: it takes .1 s
    rows = []
    for replicate in replicates:
        record = simulate(config, replicate)
        for scheme in schemes:
            found = measure(record, scheme)
            rows += [(name, scheme, key, replicate, value) for key, value in found.items()]
    return pd.DataFrame(rows, columns=["scenario", "scheme", "measure", "replicate", "value"])
