"""What is run to judge the paper's statements and the study's goals, and the scores of records."""

from __future__ import annotations

from collections.abc import Sequence

import pandas as pd
from joblib import delayed

from experiments.mehammer2018.cells import PLANES, score_plane
from experiments.mehammer2018.scenarios import OWN, PAPER, run_composed
from experiments.mehammer2018.scores import score
from experiments.parallel import compute

#: Most records of each of the paper's tests: they scatter little, and those of the decay are long.
MOST = 20


def collect(
    replicates: Sequence[int], overrides: Sequence[str] = ()
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Run all scenarios and the default maps; return the scores of both.

    Columns are those of `score_scenario` and of `cells.score_plane`. Records have the numbers
    `replicates` (of which the paper's tests take `MOST`), but those of maps. Scenarios run side by
    side, in as many processes as there are cores.
    """
    jobs = {name: delayed(score_scenario)(name, replicates[:MOST], overrides) for name in PAPER}
    jobs |= {name: delayed(score_scenario)(name, replicates, overrides) for name in OWN}
    jobs |= {plane: delayed(score_plane)(plane, overrides) for plane in PLANES}
    found = compute({f"{name}: judged": job for name, job in jobs.items()})
    scores, cells = found[: -len(PLANES)], found[-len(PLANES) :]
    return pd.concat(scores, ignore_index=True), pd.concat(cells, ignore_index=True)


def score_scenario(name: str, replicates: Sequence[int], overrides: Sequence[str]) -> pd.DataFrame:
    """Return the scores of a scenario on all records.

    Columns: scenario, scheme, measure, replicate, value.
    """
    scenario = (PAPER | OWN)[name]
    config = scenario.compose(overrides)  # once, not per record: it takes .1 s
    rows = [
        (name, scheme, measure, replicate, value)
        for replicate in replicates
        for scheme, outcome in run_composed(scenario, config, replicate).items()
        for measure, value in score(outcome).items()
    ]
    return pd.DataFrame(rows, columns=["scenario", "scheme", "measure", "replicate", "value"])
