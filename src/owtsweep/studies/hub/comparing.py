"""What a comparison of runs needs to know about a run of the hub study."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.comparing.aspects import Aspects
from owtsweep.comparing.comparison import Candidate
from owtsweep.results.conditions import Grid
from owtsweep.studies.hub import scheme_names
from owtsweep.studies.hub.conditions import BOUNDARY, CONDITIONS, get_grid
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.engines import ENGINES
from owtsweep.studies.hub.expected import answers

if TYPE_CHECKING:
    from collections.abc import Sequence

    import pandas as pd

#: The keys that a record's motion depends on besides natural period and replicate. Changing sigma,
#: delay, rate, bias or tuning changes neither the motion's phases nor the draws of the noise.
PAIRING = ("seed", "record", "spectrum", "band", "normalise")


def describe_run(run: Candidate) -> Aspects:
    """Describe a run for a comparison."""
    config: HubConfig = run.config
    window = config.measures.window

    def find_best(
        rows: pd.DataFrame, grid: Grid, schemes: Sequence[str], criterion: str
    ) -> pd.DataFrame:
        return answers.best_scheme(rows, schemes, [criterion], grid, window)

    return Aspects(
        conditions=CONDITIONS,
        grid=get_grid(config),
        schemes=scheme_names(config),
        criterion=config.measures.criterion,
        window=window,
        pairing={key: getattr(config, key) for key in PAIRING},
        boundary=BOUNDARY,
        best_of=None if ENGINES[config.engine]().samples else find_best,
    )
