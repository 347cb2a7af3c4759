"""The tables of an expected study: the same columns as those of records, without intervals."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.results.aggregate import BEST_COLUMNS, SUMMARY_COLUMNS
from owtsweep.statistics.contest import COINCIDENCE
from owtsweep.sweep.study import OK

if TYPE_CHECKING:
    import pandas as pd

    from owtsweep.studies.hub.config import HubConfig

#: Mean square errors in the order of tables.
MSE = ("x", "y", "vx", "vy", "position", "velocity")
#: Relative differences below this are within the accuracy of the curves: not distinguishable.
RESOLUTION = 1e-3
#: In grids of more cells summary.csv holds only what the map judges: all of it would be millions
#: of rows.
MOST_CELLS = 2000


@dataclass(frozen=True)
class Expected:
    """Expected MSE = N^2 motion + noise at amplitude N.

    Attributes
    ----------
    schemes
        (s,) those with results, in the study's order.
    periods
        (p,) natural periods, s, increasing.
    motion, noise
        (s, p) at 1 m, and (s, p), of one measure in one window.
    """

    schemes: tuple[str, ...]
    periods: Array
    motion: Array
    noise: Array

    def at(self, amplitudes: Array) -> Array:
        """Expected MSE, (s, p, amplitudes)."""
        squared = np.asarray(amplitudes, dtype=float) ** 2
        return np.asarray(self.motion[..., None] * squared + self.noise[..., None])


def expected(rows: pd.DataFrame, schemes: Sequence[str], measure: str, window: str) -> Expected:
    """One measure and window out of the rows of a study."""
    rows = _plain(rows)
    used = rows[(rows["status"] == OK) & (rows["measure"] == measure) & (rows["window"] == window)]
    found = tuple(name for name in schemes if (used["scheme"] == name).any())
    tables: list[pd.DataFrame] = [
        used.pivot(index="scheme", columns="natural_period", values=what).reindex(list(found))
        for what in ("motion", "noise")
    ]
    periods = tables[0].columns.to_numpy(dtype=float)
    return Expected(found, periods, tables[0].to_numpy(float), tables[1].to_numpy(float))


def _plain(rows: pd.DataFrame) -> pd.DataFrame:
    """Rows whose text is text: the store reads it as categories, which sort and map otherwise."""
    return rows.astype(dict.fromkeys(("scheme", "measure", "window"), object))


@dataclass(frozen=True)
class Verdict:
    """The best scheme of every cell; arrays (periods, amplitudes), schemes by their number.

    `runner_up` is -1 where there is but one scheme. `distinguishable`: the two differ by more than
    `RESOLUTION`.
    """

    best: NDArray[np.int64]
    runner_up: NDArray[np.int64]
    mse_best: Array
    mse_runner_up: Array
    distinguishable: NDArray[np.bool_]


def judge(values: Array) -> Verdict:
    """Least MSE and the next, of values (schemes, periods, amplitudes).

    Schemes that agree to `COINCIDENCE` count as one, under the last of their names; the runner-up
    is the best that does not coincide with the best.
    """
    count = len(values)
    number = np.arange(count)[:, None, None]
    least = values.min(axis=0)
    alike = values - least <= COINCIDENCE * values
    best = np.max(np.where(alike, number, -1), axis=0)
    mse_best = np.take_along_axis(values, best[None], axis=0)[0]
    if count == 1:
        nothing = np.full(best.shape, np.nan)
        return Verdict(best, np.full_like(best, -1), mse_best, nothing, np.zeros(best.shape, bool))
    # where all coincide the runner-up is any other
    same = np.where(np.all(alike, axis=0), number == best, alike)
    next_least = np.where(same, np.inf, values).min(axis=0)
    like_next = ~same & (values - next_least <= COINCIDENCE * values)
    runner_up = np.max(np.where(like_next, number, -1), axis=0)
    mse_next = np.take_along_axis(values, runner_up[None], axis=0)[0]
    clear = mse_next - mse_best > RESOLUTION * mse_best
    return Verdict(best, runner_up, mse_best, mse_next, clear)


def tables(config: HubConfig, rows: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """summary and best_scheme; intervals are NaN and n is 0, for there is no record."""
    from owtsweep.studies.hub import criteria, scheme_names

    names = scheme_names(config)
    return {
        "summary": summary(config, rows, names),
        "best_scheme": best_scheme(config, rows, names, criteria(config)),
    }


def summary(config: HubConfig, rows: pd.DataFrame, schemes: Sequence[str]) -> pd.DataFrame:
    """`SUMMARY_COLUMNS`, sorted as those of records."""

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
        mean=repeated["motion"] * repeated["amplitude"] ** 2 + repeated["noise"],
        ci_low=np.nan,
        ci_high=np.nan,
        n=0,
        order=repeated["scheme"].map(order),
        place=repeated["measure"].map(place),
    )
    keys = ["order", "natural_period", "amplitude", "place", "window"]
    table: pd.DataFrame = repeated.sort_values(keys, kind="stable", ignore_index=True)
    return table[list(SUMMARY_COLUMNS)]


def best_scheme(
    config: HubConfig, rows: pd.DataFrame, schemes: Sequence[str], criteria: Sequence[str]
) -> pd.DataFrame:
    """`BEST_COLUMNS`, sorted as those of records."""
    import pandas as pd

    amplitudes = np.array(sorted(config.grid.amplitude), dtype=float)
    parts = []
    for number, criterion in enumerate(criteria):
        known = expected(rows, schemes, criterion, config.measures.window)
        verdict = judge(known.at(amplitudes))
        names = np.array([*known.schemes, ""], dtype=object)  # -1 is nobody
        count = verdict.best.size
        columns: dict[str, Any] = {
            "natural_period": np.repeat(known.periods, len(amplitudes)),
            "amplitude": np.tile(amplitudes, len(known.periods)),
            "criterion": criterion,
            "window": config.measures.window,
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
    return table.sort_values(keys, kind="stable", ignore_index=True)[list(BEST_COLUMNS)]


def coinciding(
    rows: pd.DataFrame, schemes: Sequence[str], window: str, criteria: Sequence[str]
) -> list[tuple[str, ...]]:
    """Groups of schemes whose motion and noise coincide, in the order of `schemes`."""
    known = [expected(rows, schemes, criterion, window) for criterion in criteria]
    names = known[0].schemes
    marks = np.concatenate([np.hstack([one.motion, one.noise]) for one in known], axis=1)
    groups: list[list[str]] = []
    leaders: list[Array] = []
    for name, mark in zip(names, marks, strict=True):
        for group, leader in zip(groups, leaders, strict=True):
            if np.all(np.abs(mark - leader) <= COINCIDENCE * np.abs(leader)):
                group.append(name)
                break
        else:
            groups.append([name])
            leaders.append(mark)
    return [tuple(group) for group in groups if len(group) > 1]
