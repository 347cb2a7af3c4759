"""From the rows of a run to its answer: means with intervals, and the best scheme of every cell.

A cell is a natural period and an amplitude. Schemes are compared in pairs, replicate by replicate,
because all of them saw the same motion and the same noise.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.errors import InputError
from owtsweep.studies.base import OK
from owtsweep.studies.hub.cube import (
    CONFIDENCE,
    VALUE_COLUMNS,
    Cube,
    mean_and_error,
    ordered_sum,
    p_value,
    t_quantile,
)

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
#: Values that agree to this are equal up to rounding: the schemes are one and the same.
COINCIDENCE = 1e-9


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
            samples = cube.values(i, j)
            cells = np.nonzero(np.isfinite(samples).any(axis=-1))
            mean, error, n = mean_and_error(samples[cells])
            margin = t_quantile(n - 1) * error
            table: dict[str, Any] = {"scheme": scheme, "natural_period": period}
            for name, axis, index in zip(SUMMARY_COLUMNS[2:5], cube.axes[2:], cells, strict=True):
                labels = np.asarray(axis, dtype=object if isinstance(axis, tuple) else float)
                table[name] = labels[index]
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
    found: list[dict[str, Any]] = []
    for criterion in criteria if not cube.empty else ():
        measure_index = _position(cube.measures, criterion, "criteria")
        window_index = _position(cube.windows, window, "window")
        cells: list[dict[str, Any]] = []
        for i, period in enumerate(cube.natural_periods):
            measured = np.stack(
                [
                    cube.values(scheme, i, [measure_index])[:, 0, window_index]
                    for scheme in range(len(schemes))
                ]
            )
            cells += [
                {"natural_period": period, "amplitude": amplitude, "criterion": criterion}
                | {"window": window}
                | comparison
                for j, amplitude in enumerate(cube.amplitudes)
                if (comparison := _compare(measured[:, j], schemes)) is not None
            ]
        rejected = holm([float(cell["p"]) for cell in cells], level=1.0 - CONFIDENCE)
        found += [
            cell | {"distinguishable": bool(verdict)}
            for cell, verdict in zip(cells, rejected, strict=True)
        ]
    found.sort(key=lambda cell: (cell["natural_period"], cell["amplitude"]))
    return pd.DataFrame(found, columns=list(BEST_COLUMNS))


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


def _compare(cell: Floats, schemes: Sequence[str]) -> dict[str, Any] | None:
    """Best and runner-up of one cell, (scheme, replicate); None without a common replicate."""
    took_part = np.flatnonzero(np.isfinite(cell).any(axis=-1))
    common = np.isfinite(cell[took_part]).all(axis=0)
    if not took_part.size or not common.any():
        return None
    samples = cell[np.ix_(took_part, common)]
    names = [schemes[index] for index in took_part.tolist()]
    means = ordered_sum(samples) / samples.shape[1]

    everyone = np.arange(len(names))
    best, like_best = _least(means, samples, everyone)
    others = np.setdiff1d(everyone, like_best)
    told_apart = others.size > 0
    if not told_apart:
        others = np.setdiff1d(everyone, [best])
    row: dict[str, Any] = {"best": names[best], "mse_best": float(means[best])}
    if not others.size:
        nothing = dict.fromkeys(("mse_runner_up", "difference", "ci_low", "ci_high"), float("nan"))
        return row | nothing | {"runner_up": "", "p": 1.0}

    runner_up, _ = _least(means, samples, others)
    difference = means[runner_up] - means[best]
    _, error, n = mean_and_error(samples[runner_up] - samples[best])
    margin = t_quantile(n - 1) * error
    return row | {
        "runner_up": names[runner_up],
        "mse_runner_up": float(means[runner_up]),
        "difference": float(difference),
        "ci_low": float(difference - margin),
        "ci_high": float(difference + margin),
        "p": p_value(float(difference), float(error), int(n)) if told_apart else 1.0,
    }


def _least(
    means: Floats, samples: Floats, contenders: NDArray[np.intp]
) -> tuple[int, NDArray[np.intp]]:
    """The contender of least mean, by the last name of those it coincides with, and all those."""
    least = contenders[np.argmin(means[contenders])]
    alike = np.array([i for i in contenders if _same(samples[i], samples[least])])
    return int(alike[-1]), alike


def _coincide(cube: Cube, i: int, j: int, measures: list[int]) -> bool:
    """Whether two schemes agree wherever both have a value, and there is any."""
    pairs = (
        (cube.values(i, period, measures), cube.values(j, period, measures))
        for period in range(len(cube.natural_periods))
    )
    verdicts = {_agree(*pair) for pair in pairs}
    return True in verdicts and False not in verdicts


def _same(one: Floats, other: Floats) -> bool:
    """Whether all values that both have agree up to rounding, and there are any."""
    return _agree(one, other) is True


def _agree(one: Floats, other: Floats) -> bool | None:
    """As `_same`; None if there is no value that both have."""
    both = np.isfinite(one) & np.isfinite(other)
    one, other = one[both], other[both]
    if not one.size:
        return None
    scale = np.maximum(np.abs(one), np.abs(other))
    return bool(np.all(np.abs(one - other) <= COINCIDENCE * scale))


def _cube(values: pd.DataFrame | Cube, schemes: Sequence[str]) -> Cube:
    return values if isinstance(values, Cube) else Cube.of(values, schemes)
