"""Says in words what a map has found: who is best where, how good that is, and what is open."""

from __future__ import annotations

from collections.abc import Hashable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.results.conditions import Condition
from owtsweep.results.criteria import Criterion
from owtsweep.results.verdicts import SEPARATOR
from owtsweep.statistics.contest import agree

if TYPE_CHECKING:
    import pandas as pd

#: Most open cells that are named.
MOST_OPEN = 3
#: A row of best_scheme.csv.
Row = Mapping[Hashable, Any]


def tell_answer(
    cells: pd.DataFrame, ratios: pd.DataFrame, criterion: Criterion, conditions: Sequence[Condition]
) -> list[str]:
    """Return sentences on a map: verdicts, errors in the criterion's unit, and open cells.

    cells: rows of best_scheme.csv with one criterion and one window, at least one.
    ratios: the run's table ratios.csv.
    """
    if len(cells) == 1:
        return tell_cell(cells, ratios, criterion)
    sentences = [
        f"Best: {tell_counts(cells)}",
        f"Error of the best: {_tell_range(cells['error_best'], criterion)}.",
    ]
    ratio = cells["error_runner_up"] / cells["error_best"]
    ratio = ratio[np.isfinite(ratio)]
    if len(ratio):
        sentences.append(
            f"Error of the runner-up: {ratio.min():.4g} to {ratio.max():.4g} times as large, "
            f"median {ratio.median():.4g}{_tell_shared(cells, ratios, 'runner_up')}."
        )
    if "error_baseline" in cells and cells["error_baseline"].notna().any():
        sentences.append(
            f"No estimator (best baseline): {_tell_range(cells['error_baseline'], criterion)}"
            f"{_tell_shared(cells, ratios, 'baseline')}."
        )
    if (cells["look"] > 0).all():
        sentences.append(
            f"Failures in fewer than 3 of {cells['n'].min()} records could not be seen."
        )
    return sentences + _tell_open(cells, conditions)


def tell_counts(cells: pd.DataFrame) -> str:
    """Return in how many cells which scheme is best, and how many are won, tied and open."""
    verdicts = cells["verdict"].value_counts()
    counted = ", ".join(f"{verdicts.get(name, 0)} {name}" for name in ("won", "tie", "open"))
    return f"{count_names(cells['best'])} of {len(cells)} cells ({counted})."


def tell_cell(
    cells: pd.DataFrame, ratios: pd.DataFrame, criterion: Criterion, counted: str = "record"
) -> list[str]:
    """Return sentences on the only cell: its best scheme, error, runner-up, and what is open.

    `counted` is what the column `n` counts, in the singular; 0 of them are not told.
    """
    row: Row = cells.iloc[0].to_dict()
    how = {"won": "is best", "tie": "is the simplest of a tie", "open": "is best so far"}
    low, high = row["error_low"], row["error_high"]
    interval = f" (95 %: {low:.3g} to {high:.3g})" if np.isfinite(low) else ""
    records = f", {row['n']} {counted}{'s' * (row['n'] != 1)}" if row["n"] else ""
    error = f"error {criterion.show(row['error_best'])}{interval}"
    sentences = [f"{row['best']} {how[row['verdict']]}: {error}{records}."]
    if row["runner_up"]:
        ratio = row["error_runner_up"] / row["error_best"]
        sentences.append(
            f"Runner-up: {row['runner_up']}, {criterion.show(row['error_runner_up'])}, "
            f"{ratio:.4g} times as much{_tell_shared(cells, ratios, 'runner_up')}."
        )
    if row.get("baseline") and row["baseline"] != row["best"]:
        error = criterion.show(row["error_baseline"]) + _tell_shared(cells, ratios, "baseline")
        sentences.append(f"No estimator (best baseline {row['baseline']}): {error}.")
    if row["verdict"] != "won" and row.get("left"):
        sentences.append(f"Not surely worse: {', '.join(_list_others(row))}.")
    if row.get("more"):
        sentences.append(f"Some {row['more']:.2g} more records would decide.")
    return sentences


def tell_beaten(
    names: Sequence[str], cells: pd.DataFrame, ratios: pd.DataFrame, criterion: Criterion
) -> list[str]:
    """Return a sentence on the error of each of some schemes that is best in no cell.

    cells: rows of best_scheme.csv with one criterion and one window: one row per cell.
    ratios: the run's table ratios.csv.
    """
    keys, sentences = _list_keys(ratios), []
    for name in names:
        if (cells["best"] == name).any():
            continue
        own = ratios.loc[ratios["scheme"] == name, [*keys, "error", "n"]]
        both = cells[[*keys, "error_best"]].merge(own, on=keys)
        if both.empty:
            sentences.append(f"{name} is best in no cell: it has no result.")
            continue
        ratio, n = both["error"] / both["error_best"], both["n"]
        records = f", over {_tell_ends(n, 'd')} records of both" * bool(n.max())
        sentences.append(
            f"{name} is best in no cell: its error is {_tell_range(both['error'], criterion)}, "
            f"{_tell_ends(ratio, '.3g')} times the least{records}."
        )
    return sentences


def tell_alike(names: Sequence[str], summary: pd.DataFrame, criteria: Sequence[str]) -> list[str]:
    """Return sentences on those of some schemes that have the errors of another contender.

    summary: the run's table summary.csv. Two are alike by a criterion if all means that both have
    agree, in every cell.
    """
    cells = [*summary.columns[: summary.columns.get_loc("mean")]]
    index = [name for name in cells if name != "scheme"]
    judged = summary[summary["measure"].isin(list(criteria))]
    means = judged.pivot(index=index, columns="scheme", values="mean")
    sentences = []
    for name in means.columns.intersection([*names]):  # others have no result
        for other in means.columns.difference([name, *names], sort=False):
            both = means[[name, other]].dropna()
            same = both.assign(same=agree(both[name].to_numpy(), both[other].to_numpy()))["same"]
            by = same.groupby("measure", sort=False).all()
            alike = [str(measure).replace("_", " ") for measure in by.index[by]]
            if alike:
                what = "" if len(alike) == len(by) else f", by {' and '.join(alike)}"
                sentences.append(f"{name} and {other} give the same errors in every cell{what}.")
    return sentences


def _list_keys(ratios: pd.DataFrame) -> list[str]:
    """Return the columns that say to what cell a line belongs, here and in best_scheme.csv."""
    return [*ratios.columns[: ratios.columns.get_loc("scheme")]]


def _tell_shared(cells: pd.DataFrame, ratios: pd.DataFrame, column: str) -> str:
    """Say over how many records those that a column names are compared, if not over all."""
    cells = cells[cells[column].isin(ratios["scheme"])]
    if cells.empty:  # nobody beside the best; of a stored table the column is then of numbers
        return ""
    keys = [*_list_keys(ratios), column]
    own = ratios.rename(columns={"scheme": column, "n": "shared"})
    both = cells.merge(own[[*keys, "shared"]], on=keys)
    fewer = bool((both["shared"] < both["n"]).any())
    return f", over {_tell_ends(both['shared'], 'd')} records of both" if fewer else ""


def _tell_open(cells: pd.DataFrame, conditions: Sequence[Condition]) -> list[str]:
    still = cells[(cells["verdict"] == "open") & (cells["look"] > 0)]
    sentences = []
    for row in still.head(MOST_OPEN).to_dict("records"):
        where = ", ".join(f"{c.word} {c.show(row[c.name])}" for c in conditions)
        names = " or ".join([row["best"], *_list_others(row)])
        more = f"; some {row['more']:.2g} more records would decide" if row.get("more") else ""
        sentences.append(f"Open after {row['n']} records: {where}: {names}{more}.")
    if len(still) > MOST_OPEN:
        sentences.append(f"{len(still) - MOST_OPEN} more cells are open: see best_scheme.csv.")
    return sentences


def _list_others(row: Row) -> list[str]:
    return [name for name in row["left"].split(SEPARATOR) if name != row["best"]]


def _tell_ends(numbers: pd.Series[float], form: str) -> str:
    """Return the least and the largest number as text, or the one if they read alike."""
    ends = (f"{numbers.min():{form}}", f"{numbers.max():{form}}")
    return " to ".join(dict.fromkeys(ends))


def _tell_range(errors: pd.Series[float], criterion: Criterion) -> str:
    low, high = float(errors.min()), float(errors.max())
    unit = f" {criterion.unit}" if criterion.unit else ""
    return f"{low:.3g} to {high:.3g}{unit}, median {float(errors.median()):.3g}{unit}"


def count_names(names: pd.Series[str]) -> str:
    """Return how often each name stands in a column, the commonest first: "HME1 in 3, MKF in 1"."""
    counts = names.value_counts(sort=False).sort_values(ascending=False, kind="stable")
    return ", ".join(f"{name} in {n}" for name, n in counts.items())
