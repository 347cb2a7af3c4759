"""Draw maps of the scheme with the least regret: over the worlds on average, and in the worst."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

import pandas as pd

from owtsweep.results.conditions import Condition
from owtsweep.results.regret import SUMMARY, make_map_table

if TYPE_CHECKING:
    from matplotlib.figure import Figure

#: Kind of regret -> the map's title.
TITLES = {"mean": "mean regret of", "worst": "worst regret of"}
NOTE = (
    "Regret: a scheme's error over the least of any contender in a world, here over all worlds of "
    "`over`."
)


def list_maps(
    tables: Mapping[str, pd.DataFrame],
    schemes: Sequence[str],
    conditions: Sequence[Condition],
    tuning: str,
    records: str,
) -> dict[str, Callable[[], Figure]]:
    """Return name -> function that draws; none without tables of regret.

    Arguments are as of `best_scheme_map.draw`.
    """
    if SUMMARY not in tables or tables[SUMMARY].empty:
        return {}

    def draw(kind: str) -> Figure:
        from owtsweep.figures import best_scheme_map

        table = make_map_table(tables[SUMMARY], conditions, kind)
        return best_scheme_map.draw(
            table,
            schemes,
            conditions,
            criterion=table["criterion"][0],
            window=table["window"][0],
            tuning=tuning,
            quantity=f"{TITLES[kind]} {table['criterion'][0]}",
            records=records,
            notes=[NOTE],
        )

    return {f"regret_{kind}": partial(draw, kind) for kind in TITLES}
