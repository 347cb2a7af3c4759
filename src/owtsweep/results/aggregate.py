"""From the rows of a run to its answer: means with intervals, and the best scheme of every cell.

A cell is a natural period and an amplitude. Schemes are compared in pairs, replicate by replicate,
because all of them saw the same motion and the same noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.errors import InputError
from owtsweep.results.cube import CONFIDENCE, VALUE_COLUMNS, Cube, mean_and_error, t_quantile
from owtsweep.statistics.contest import agree, contest
from owtsweep.sweep.study import OK

if TYPE_CHECKING:
    import pandas as pd
    from numpy.typing import NDArray

    Floats = NDArray[np.float64]

SUMMARY_COLUMNS = (
    "scheme",
    "natural_period",
    "amplitude",
    "measure",
    "window",
    "mean",
    "ci_low",
    "ci_high",
    "n",
)
BEST_COLUMNS = (
    "natural_period",
    "amplitude",
    "criterion",
    "window",
    "best",
    "runner_up",
    "mse_best",
    "mse_runner_up",
    "difference",
    "ci_low",
    "ci_high",
    "distinguishable",
)
CRITERIA = ("position", "velocity")


def expand(rows: pd.DataFrame, amplitudes: Sequence[float]) -> pd.DataFrame:
    """One value per scheme, cell, measure, window and replicate.

    Parameters
    ----------
    rows
        The rows of a run's cases. A superposed row (`amplitude` NaN) stands for every amplitude N:
        value = N^2 motion + 2 N cross + noise; a direct row holds `amplitude` and `value`.
    amplitudes
        The grid's amplitudes (m); direct rows at others are left out.

    Returns
    -------
    DataFrame
        `VALUE_COLUMNS`, in no particular order. MSE of positions in m^2, of velocities in m^2/s^2,
        NEES and NIS without unit. Failed cases and values that are not finite (a scheme without
        covariance has no NEES) are absent.
    """
    import pandas as pd

    finished = rows[rows["status"] == OK]
    is_superposed = finished["amplitude"].isna()
    direct = finished[~is_superposed & finished["amplitude"].isin(list(amplitudes))]

    superposed = finished[is_superposed]
    factors = np.unique(np.asarray(amplitudes, dtype=float))
    motion, cross, noise = (
        superposed[name].to_numpy(dtype=float)[:, np.newaxis]
        for name in ("motion", "cross", "noise")
    )
    repeated = superposed.iloc[np.repeat(np.arange(len(superposed)), len(factors))]
    expanded = repeated.assign(
        amplitude=np.tile(factors, len(superposed)),
        value=(factors**2 * motion + 2.0 * factors * cross + noise).ravel(),
    )

    # concat would warn of, and take its dtypes from, a part without rows
    parts = [part for part in (expanded, direct) if len(part)] or [expanded]
    values: pd.DataFrame = pd.concat(parts, ignore_index=True)[list(VALUE_COLUMNS)]
    values = values[np.isfinite(values["value"].to_numpy(dtype=float))]
    return values.reset_index(drop=True)


def summary(values: pd.DataFrame | Cube, schemes: Sequence[str]) -> pd.DataFrame:
    """Mean over the replicates with its 95 % Student-t interval (NaN for a single replicate).

    Parameters
    ----------
    values
        As `expand` returns them, or the cube of these schemes.
    schemes
        The schemes to report, in the order of the result.

    Returns
    -------
    DataFrame
        `SUMMARY_COLUMNS`, sorted by scheme, natural period, amplitude, measure, window; `n` is the
        number of replicates that the scheme finished.
    """
    import pandas as pd

    cube = _cube(values, schemes)
    parts: list[pd.DataFrame] = []
    for i, scheme in enumerate(schemes if not cube.empty else ()):
        for j, period in enumerate(cube.natural_periods):
            with np.errstate(invalid="ignore"):  # cells without any value: 0 / 0
                mean, error, n = mean_and_error(cube.values(i, j))
            cells = np.nonzero(n)
            mean, error, n = mean[cells], error[cells], n[cells]
            margin = t_quantile(n - 1) * error
            table: dict[str, Any] = {"scheme": scheme, "natural_period": period}
            for name, axis, index in zip(SUMMARY_COLUMNS[2:5], cube.axes[2:], cells, strict=True):
                table[name] = pd.Index(axis).take(index)
            table |= {"mean": mean, "ci_low": mean - margin, "ci_high": mean + margin, "n": n}
            parts.append(pd.DataFrame(table, columns=list(SUMMARY_COLUMNS)))
    found = [part for part in parts if len(part)]
    if not found:
        return pd.DataFrame(columns=list(SUMMARY_COLUMNS))
    return pd.concat(found, ignore_index=True)


def best_scheme(
    values: pd.DataFrame | Cube,
    schemes: Sequence[str],
    window: str,
    criteria: Sequence[str] = CRITERIA,
) -> pd.DataFrame:
    """The scheme of least mean MSE in every cell, and whether the data tell it from the next.

    Means are over the replicates that all schemes finished; a scheme that finished none in a cell
    takes no part there, and a cell without a common replicate has no row. Schemes that agree to
    `COINCIDENCE` in every replicate count as one, under the name listed last in `schemes`; the
    runner-up is the best scheme that does not coincide with the best one.

    Parameters
    ----------
    values
        As `expand` returns them, or the cube of these schemes.
    schemes
        The schemes to compare; their order decides the name of coinciding ones.
    window
        "full" or "settled".
    criteria
        Measures to judge by, each on its own.

    Returns
    -------
    DataFrame
        `BEST_COLUMNS`, sorted by natural period, amplitude, criterion. `ci_low` and `ci_high` are
        the 95 % paired t interval of `difference` in that cell alone; `distinguishable` applies
        Holm's step-down correction over all cells of the criterion at 5 %. With one scheme
        `runner_up` is empty and the numbers that need it are NaN; with one replicate the interval
        is NaN. Neither is distinguishable.

    Raises
    ------
    InputError
        If a criterion or the window was not measured.
    """
    import pandas as pd

    cube = _cube(values, schemes)
    names = np.array([*schemes, ""], dtype=object)  # place -1: no runner-up
    tables: list[pd.DataFrame] = []
    for criterion in criteria if not cube.empty else ():
        measure = _position(cube.measures, criterion, "criteria")
        at = _position(cube.windows, window, "window")
        results = [
            contest(np.stack([cube.values(i, j, [measure])[:, 0, at] for i in range(len(schemes))]))
            for j in range(len(cube.natural_periods))
        ]
        table = pd.concat(
            [
                pd.DataFrame(
                    {"natural_period": period, "amplitude": cube.amplitudes, "criterion": criterion}
                    | {"window": window}
                    | result._asdict()
                ).assign(best=names[result.best], runner_up=names[result.runner_up])[result.judged]
                for period, result in zip(cube.natural_periods, results, strict=True)
            ]
        )
        tables.append(
            table.assign(distinguishable=holm(table["p"].to_list(), level=1.0 - CONFIDENCE))
        )
    if not tables:
        return pd.DataFrame(columns=list(BEST_COLUMNS))
    order = ["natural_period", "amplitude"]
    whole = pd.concat(tables).sort_values(order, kind="stable", ignore_index=True)
    return whole[list(BEST_COLUMNS)]


def coinciding(values: pd.DataFrame | Cube, schemes: Sequence[str]) -> list[tuple[str, ...]]:
    """Groups of schemes whose position and velocity MSE coincide in every cell and replicate.

    Each group is in the order of `schemes`, so its last member is the name that `best_scheme` uses.
    """
    cube = _cube(values, schemes)
    judged = [index for index, measure in enumerate(cube.measures) if measure in CRITERIA]
    groups: list[tuple[str, ...]] = []
    grouped: set[str] = set()
    for i, name in enumerate(schemes if not cube.empty else ()):
        if name in grouped:
            continue
        same = [j for j in range(i + 1, len(schemes)) if _coincide(cube, i, j, judged)]
        if same:
            groups.append((name, *(schemes[j] for j in same)))
            grouped.update(groups[-1])
    return groups


def holm(p_values: Sequence[float], *, level: float = 0.05) -> NDArray[np.bool_]:
    """Holm's step-down test: which hypotheses fall at a family-wise error of `level`.

    Source: Holm (1979), A simple sequentially rejective multiple test procedure.
    """
    p = np.asarray(p_values, dtype=float)
    order = np.argsort(p, kind="stable")
    passed = p[order] <= level / (p.size - np.arange(p.size))
    rejected = np.zeros(p.size, dtype=bool)
    rejected[order] = np.logical_and.accumulate(passed)
    return rejected


def _position(labels: Sequence[str], label: str, argument: str) -> int:
    if label not in labels:
        raise InputError(f"{argument}: {label!r} was not measured; use {' or '.join(labels)}")
    return labels.index(label)


def _coincide(cube: Cube, i: int, j: int, measures: list[int]) -> bool:
    """Whether two schemes agree wherever both have a value, and there is any."""
    pairs = (
        (cube.values(i, period, measures), cube.values(j, period, measures))
        for period in range(len(cube.natural_periods))
    )
    verdicts = {_agree(*pair) for pair in pairs}
    return True in verdicts and False not in verdicts


def _agree(one: Floats, other: Floats) -> bool | None:
    """Whether all values that both have coincide; None if there is none."""
    both = np.isfinite(one) & np.isfinite(other)
    one, other = one[both], other[both]
    if not one.size:
        return None
    return bool(np.all(agree(one, other)))


def _cube(values: pd.DataFrame | Cube, schemes: Sequence[str]) -> Cube:
    return values if isinstance(values, Cube) else Cube.of(values, schemes)
