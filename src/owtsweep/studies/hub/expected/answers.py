"""The tables of an expected study. Columns are those of a study of records, without intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.best_scheme import name_columns as best_columns
from owtsweep.results.conditions import Value
from owtsweep.results.status import OK
from owtsweep.results.summary import name_columns as summary_columns
from owtsweep.results.superposition import superpose
from owtsweep.statistics.contest import agree, find_alike, group_coinciding, rank
from owtsweep.studies.hub.conditions import CONDITIONS

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.studies.hub.config import HubConfig

NAMES = [condition.name for condition in CONDITIONS]
#: Mean square errors in the order of tables.
MSE = ("x", "y", "vx", "vy", "position", "velocity")
#: Two schemes are distinguishable if they differ by more than this (relative), which is the
#: accuracy of the curves.
RESOLUTION = 1e-3
#: In grids of more cells than this, summary.csv holds only the measures that the map judges. All
#: measures would make millions of rows.
MOST_CELLS = 2000


@dataclass(frozen=True)
class Expected:
    """Expected MSE = N^2 motion + noise at amplitude N.

    Attributes
    ----------
    schemes
        (s,) schemes with results, in the study's order.
    periods
        (p,) natural periods, s, increasing.
    motion, noise
        (s, p) each: mean square errors from motion of 1 m and from noise, of one measure in one
        window.
    """

    schemes: tuple[str, ...]
    periods: Array
    motion: Array
    noise: Array

    def at(self, amplitudes: Array) -> Array:
        """Expected MSE, (s, p, amplitudes)."""
        N = np.asarray(amplitudes, dtype=float)
        return np.asarray(superpose(self.motion[..., None], 0.0, self.noise[..., None], N))


def expected(rows: pd.DataFrame, schemes: Sequence[str], measure: str, window: str) -> Expected:
    """Select one measure and one window from the rows of a study."""
    rows = _plain(rows)
    used = rows[(rows["status"] == OK) & (rows["measure"] == measure) & (rows["window"] == window)]
    present = tuple(name for name in schemes if (used["scheme"] == name).any())
    tables: list[pd.DataFrame] = [
        used.pivot(index="scheme", columns="natural_period", values=what).reindex(list(present))
        for what in ("motion", "noise")
    ]
    periods = tables[0].columns.to_numpy(dtype=float)
    return Expected(present, periods, tables[0].to_numpy(float), tables[1].to_numpy(float))


def _plain(rows: pd.DataFrame) -> pd.DataFrame:
    """Convert the store's categories to plain text, because categories sort and map differently."""
    return rows.astype(dict.fromkeys(("scheme", "measure", "window"), object))


@dataclass(frozen=True)
class Verdict:
    """The best scheme of every cell: arrays (periods, amplitudes) of scheme numbers.

    `runner_up` is -1 where there is only one scheme. `distinguishable` says whether best and
    runner-up differ by more than `RESOLUTION`.
    """

    best: NDArray[np.int64]
    runner_up: NDArray[np.int64]
    mse_best: Array
    mse_runner_up: Array
    distinguishable: NDArray[np.bool_]


def judge(values: Array) -> Verdict:
    """Find the least MSE and the next, from values (schemes, periods, amplitudes).

    Schemes that agree up to rounding count as one, under the last of their names. The runner-up is
    the best scheme that does not coincide with the winner (`statistics.contest.rank`).
    """
    flat = values.reshape(len(values), -1)
    everybody = np.ones(flat.shape, dtype=bool)
    alike = find_alike(flat[..., np.newaxis], everybody, everybody[0][:, np.newaxis])
    ranking = rank(flat, alike, everybody)
    best, runner_up = (place.reshape(values.shape[1:]) for place in ranking[:2])
    mse_best = np.take_along_axis(values, best[np.newaxis], axis=0)[0]
    mse_next = np.take_along_axis(values, runner_up[np.newaxis], axis=0)[0]
    mse_next = np.where(runner_up < 0, np.nan, mse_next)
    return Verdict(best, runner_up, mse_best, mse_next, mse_next - mse_best > RESOLUTION * mse_best)


def tables(config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """The tables summary and best_scheme. There are no records: intervals are NaN and n is 0."""
    from owtsweep.studies.hub import criteria, scheme_names

    names = scheme_names(config)
    return {
        "summary": summary(config, rows, names),
        "best_scheme": best_scheme(
            rows, names, criteria(config), config.grid.amplitude, config.measures.window
        ),
    }


def summary(config: HubConfig, rows: pd.DataFrame, schemes: Sequence[str]) -> pd.DataFrame:
    """The summary, sorted like that of a study of records."""
    amplitudes = np.array(sorted(config.grid.amplitude), dtype=float)
    rows = _plain(rows)
    used = rows[rows["status"] == OK]
    if len(amplitudes) * len(config.grid.natural_period) > MOST_CELLS:
        judged = used["measure"] == config.measures.criterion
        used = used[judged & (used["window"] == config.measures.window)]
    order = {name: i for i, name in enumerate(schemes)}
    place = {name: i for i, name in enumerate(MSE)}
    repeated = used.loc[used.index.repeat(len(amplitudes))].assign(
        amplitude=np.tile(amplitudes, len(used))
    )
    repeated = repeated.assign(
        mean=superpose(repeated["motion"], 0.0, repeated["noise"], repeated["amplitude"]),
        ci_low=np.nan,
        ci_high=np.nan,
        n=0,
        order=repeated["scheme"].map(order),
        place=repeated["measure"].map(place),
    )
    keys = ["order", "natural_period", "amplitude", "place", "window"]
    table: pd.DataFrame = repeated.sort_values(keys, kind="stable", ignore_index=True)
    return table[summary_columns(NAMES)]


def best_scheme(
    rows: pd.DataFrame,
    schemes: Sequence[str],
    criteria: Sequence[str],
    amplitudes: Sequence[Value],
    window: str,
) -> pd.DataFrame:
    """The best scheme of every cell, sorted as in a study of records."""
    import pandas as pd

    levels = np.array(sorted(amplitudes), dtype=float)
    parts = []
    for number, criterion in enumerate(criteria):
        curves = expected(rows, schemes, criterion, window)
        verdict = judge(curves.at(levels))
        names = np.array([*curves.schemes, ""], dtype=object)  # -1: no runner-up
        count = verdict.best.size
        columns: dict[str, Any] = {
            "natural_period": np.repeat(curves.periods, len(levels)),
            "amplitude": np.tile(levels, len(curves.periods)),
            "criterion": criterion,
            "window": window,
            "best": names[verdict.best.ravel()],
            "runner_up": names[verdict.runner_up.ravel()],
            "mse_best": verdict.mse_best.ravel(),
            "mse_runner_up": verdict.mse_runner_up.ravel(),
            "difference": (verdict.mse_runner_up - verdict.mse_best).ravel(),
            "ci_low": np.full(count, np.nan),
            "ci_high": np.full(count, np.nan),
            "distinguishable": verdict.distinguishable.ravel(),
            "order": number,
        }
        parts.append(pd.DataFrame(columns))
    table = pd.concat(parts, ignore_index=True)
    keys = ["natural_period", "amplitude", "order"]
    return table.sort_values(keys, kind="stable", ignore_index=True)[best_columns(NAMES)]


def coinciding(
    rows: pd.DataFrame, schemes: Sequence[str], window: str, criteria: Sequence[str]
) -> list[tuple[str, ...]]:
    """Groups of schemes whose motion and noise coincide, in the order of `schemes`."""
    curves = [expected(rows, schemes, criterion, window) for criterion in criteria]
    names = curves[0].schemes
    marks = np.concatenate([np.hstack([one.motion, one.noise]) for one in curves], axis=1)
    return group_coinciding(names, lambda i, j: bool(np.all(agree(marks[i], marks[j]))))
