"""Makes the table best_scheme.csv: the best scheme of every cell, and whether the data show it.

Baselines do not compete. Columns of their own say whether the best of them beats the best scheme.
Schemes are compared replicate by replicate, because in each replicate all schemes get the same
motion and the same noise.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.errors import require
from owtsweep.results.conditions import sort_lines
from owtsweep.results.criteria import Criterion
from owtsweep.results.cube import Cube
from owtsweep.results.status import OK, UNABLE
from owtsweep.statistics.contest import agree, challenge, contest, group_coinciding
from owtsweep.statistics.inference import holm

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["find_best_schemes"]

VERDICT_COLUMNS = (
    "criterion", "window", "best", "runner_up", "mse_best", "mse_runner_up", "difference",
    "ci_low", "ci_high", "distinguishable",
)  # fmt: skip

#: Further columns of a run with baselines.
BASELINE_COLUMNS = ("baseline", "mse_baseline", "baseline_wins")
#: Columns in the unit of the criterion, and what they rest on.
ERROR_COLUMNS = (
    "verdict", "best_scheme", "look", "n", "error_best", "error_low", "error_high",
    "error_runner_up",
)  # fmt: skip


def find_best_schemes(
    cube: Cube,
    window: str,
    criteria: Sequence[str] | Mapping[str, Criterion],
    baselines: Sequence[str] = (),
) -> pd.DataFrame:
    """Find the scheme of least mean in every cell, and whether the runner-up is distinguishable.

    A scheme that finished no replicate in a cell takes no part in that cell. Means are over the
    replicates that all schemes taking part in the cell have finished; a cell without such a
    replicate has no row. Schemes whose values agree to `statistics.contest.COINCIDENCE` in each of
    these replicates count as one scheme, under the name that comes last in `cube.schemes`. The
    runner-up is the best of the other schemes; if all schemes of a cell agree, the runner-up is
    another of these schemes. Raise `InputError` if a criterion or the window was not measured.

    Return the conditions, `VERDICT_COLUMNS`, `ERROR_COLUMNS` and, if there are baselines,
    `BASELINE_COLUMNS` and `error_baseline`, sorted by conditions, then in the order of `criteria`.
    `difference` is the runner-up's mean minus the best scheme's; `ci_low` and `ci_high` are the
    ends of its 95 % confidence interval by the paired t-test in that cell alone. `distinguishable`
    applies Holm's step-down correction at 5 % to all cells of the criterion. In a cell with one
    scheme, `runner_up` is empty and the numbers that need a runner-up are NaN. In a cell with one
    replicate, the interval is NaN. In both cases `distinguishable` is false. `baseline` is the
    baseline of least mean, and `mse_baseline` its mean. `baseline_wins` says whether `mse_baseline`
    is less than the best scheme's mean and the paired difference is significant, with Holm's
    correction as above. If a scheme was unable to work in any cell, there are also the columns
    `status` and `reason`. The verdict is "won" where `distinguishable`, else "open"; `look` is 0,
    because there were no looks; `n` is the number of compared replicates. `error_low` and
    `error_high` are the ends of a 95 % interval. A root of a mean square is averaged as it is.

    window: the window to judge.
    criteria: the measures to judge by, with the unit of their errors; errors are the means
        themselves where only names are given. Each measure gives rows of its own.
    baselines: Those of `cube.schemes` that do not compete. In each cell, the best scheme is
        compared with the baseline of least mean, over the replicates that decide between the
        schemes.
    """
    import pandas as pd

    columns = [*cube.names, *VERDICT_COLUMNS, *(BASELINE_COLUMNS if baselines else ())]
    columns += [*ERROR_COLUMNS, *(["error_baseline"] if baselines else [])]
    last = cube.names[-1]
    competing = [i for i, name in enumerate(cube.schemes) if name not in baselines]
    beside = [cube.schemes.index(name) for name in baselines]
    names = np.array([*(cube.schemes[i] for i in competing), ""], dtype=object)  # -1: no runner-up
    beside_names = np.array([*baselines, ""], dtype=object)
    tables: list[pd.DataFrame] = []
    for criterion in criteria if not cube.empty else ():
        _require_measured(cube.measures, criterion, "criteria")
        _require_measured(cube.windows, window, "window")
        parts = []
        for place in cube.outer_places():
            values = cube.values_of(place, criterion, window, competing)
            result = contest(values)
            verdict = result._asdict() | {
                "best": names[result.best],
                "runner_up": names[result.runner_up],
            }
            if beside:
                others = cube.values_of(place, criterion, window, beside)
                duel = challenge(values, result.best, others)
                verdict |= duel._asdict() | {"baseline": beside_names[duel.baseline]}
            cells = cube.name_outer(place) | {last: cube.levels[-1], "criterion": criterion}
            part = pd.DataFrame(cells | {"window": window} | verdict)
            parts.append(part[result.judged])
        table = pd.concat(parts)
        table = table.assign(distinguishable=holm(table["p"]))
        table["verdict"] = np.where(table["distinguishable"], "won", "open")
        table["best_scheme"], table["look"] = table["best"], 0
        squares = isinstance(criteria, Mapping) and criteria[criterion].values == "square"
        for name in ("best", "low", "high", "runner_up", *(["baseline"] if baselines else [])):
            mean = table[f"mse_{name}"]
            table[f"error_{name}"] = mean.clip(lower=0.0) ** 0.5 if squares else mean
        if baselines:
            table["baseline_wins"] = holm(table["p_baseline"]) & (table["gain"] > 0.0)
        tables.append(table)
    if not tables:
        return pd.DataFrame(columns=columns)
    return finish(pd.concat(tables)[columns], cube)


def finish(table: pd.DataFrame, cube: Cube) -> pd.DataFrame:
    """Sort a table best_scheme by the conditions, and say where a scheme was unable to work.

    If one was in any cell, there are also the columns `status` and `reason`. The status is "unable"
    where a scheme was, which the reason names; otherwise it is "ok", and the reason "".
    """
    table, unable = sort_lines(table, dict(zip(cube.names, cube.levels, strict=True))), cube.unable
    if unable.empty:
        return table
    who = unable["scheme"] + ": " + unable["reason"]
    reasons = who.groupby([unable[name] for name in cube.names]).agg("; ".join).rename("reason")
    marked = table.merge(reasons, how="left", left_on=cube.names, right_index=True)
    marked["reason"] = marked["reason"].fillna("")
    marked["status"] = [UNABLE if reason else OK for reason in marked["reason"]]
    return marked[[*table.columns, "status", "reason"]]


def find_coinciding(
    cube: Cube, criteria: Sequence[str], contenders: Sequence[str] = ()
) -> list[tuple[str, ...]]:
    """Find groups of schemes whose values are equal up to rounding, everywhere and by all criteria.

    The last member of a group is the name that stands for the group in the table best_scheme:
    the simplest, if `contenders` names them all, the simplest first; else the last in
    `cube.schemes`.
    """
    judged = [index for index, measure in enumerate(cube.measures) if measure in criteria]

    def coincide(i: int, j: int) -> bool:
        """Return whether values agree wherever both schemes have one, which is somewhere."""
        compared = False
        for place in cube.outer_places():
            one, other = cube.values(i, place, judged), cube.values(j, place, judged)
            both = np.isfinite(one) & np.isfinite(other)
            if not agree(one[both], other[both]).all():
                return False
            compared |= bool(both.any())
        return compared

    groups = group_coinciding(cube.schemes, coincide)
    order = contenders[::-1] or cube.schemes  # the last of a group stands for it
    return [tuple(sorted(group, key=order.index)) for group in groups]


def _require_measured(labels: Sequence[str], label: str, argument: str) -> None:
    require(label in labels, f"{argument}: {label!r} was not measured; use {' or '.join(labels)}")
