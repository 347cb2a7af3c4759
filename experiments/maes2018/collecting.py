"""Runs all scenarios on several records and collects their scores."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING

from experiments.maes2018 import scores
from experiments.maes2018.scenarios import COASTING, REFERENCE, compose_cell, simulate
from owtsweep.io.steps import tell_step
from owtsweep.verdicts.scores import tabulate

if TYPE_CHECKING:
    import pandas as pd

#: Scenario -> overrides, and what is measured of it.
SCENARIOS: dict[str, tuple[tuple[str, ...], Callable[..., dict[str, float]]]] = {
    **{name: (words, scores.score_reference) for name, words in REFERENCE.items()},
    "filters": ((), scores.score_filters),
    "coasting": (COASTING, scores.score_coasting),
    "boom": ((), scores.score_boom),
}
#: What needs no record of the blade.
ALONE = {"geometry": scores.score_geometry}


def collect(replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Run all scenarios; return their scores (see `verdicts.scores.tabulate`).

    Records have the numbers `replicates`. Scenarios run side by side, in as many processes as there
    are cores.
    """
    import pandas as pd
    from joblib import Parallel, delayed

    names = [*SCENARIOS, *ALONE]
    tables = Parallel(n_jobs=-1, return_as="generator")(
        delayed(score)(name, replicates, overrides) for name in names
    )
    found = []
    for name, table in zip(names, tables, strict=True):
        tell_step(f"{name}: judged")
        found.append(table)
    joined: pd.DataFrame = pd.concat(found, ignore_index=True)
    return joined


def score(name: str, replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Return the scores of a scenario on records."""
    if name in ALONE:
        return tabulate(name, {k: ALONE[name](k) for k in replicates})
    words, judge = SCENARIOS[name]
    config = compose_cell([*words, *overrides])  # once, not per record: it takes .1 s
    return tabulate(name, {k: judge(simulate(config, k)) for k in replicates})
