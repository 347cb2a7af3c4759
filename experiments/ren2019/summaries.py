"""Make the table fidelity.csv, which compares a run with the published results of the paper.

The paper is Ren et al. (2019). The table has one row per published item.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import pandas as pd

from experiments.ren2019.evidence import SCHEMES, TABLE_CELLS, Evidence, tolerated
from experiments.ren2019.numbers import lies_within_records
from experiments.ren2019.published import BOUNDARIES
from experiments.single_record import place_print
from owtsweep.verdicts.inference import (
    MISSING,
    NOT_REPRODUCED,
    REPRODUCED,
    Decision,
    Estimate,
    JudgedClaim,
    JudgedStatement,
    all_of,
    explain,
    mean_ratio,
)

NAN = float("nan")
#: What the names of statements that are judged in x alone end with.
X_ALONE = ", x alone"
#: Natural period (s) -> the statement on the boundary there; and that on its growth.
ON_BOUNDARY, ON_GROWTH = {4.0: "F3", 6.0: "F4"}, "F5"
#: Groups of schemes whose distances from the published numbers are told.
GROUPS = (("MKF", "HME1", "HME2"), ("EKF",))
NO_BOUNDARY = "period, scheme or superposed cases not in this run"


@dataclass(frozen=True)
class Item:
    """A published item, e.g. a number or a statement, and the run's result for this item.

    Attributes
    ----------
    item
        The name of the item.
    kind
        "number", "statement", "boundary", "winner" or "summary".
    published
        The published value; NaN if none is published.
    reproduced, ci_low, ci_high
        The run's value and the ends of its 95 % interval; NaN where unknown.
    agrees
        Whether the run agrees: "yes", "no", "undecided" or "missing"; for a statement, its verdict;
        "" if there is nothing to agree with.
    why
        The reason for `agrees` or for a difference, in words.
    """

    item: str
    kind: str
    published: float = NAN
    reproduced: float = NAN
    ci_low: float = NAN
    ci_high: float = NAN
    agrees: str = MISSING
    why: str = ""

    def judged(self, result: Decision | Estimate, verdict: str, why: str) -> Item:
        """Return a copy of the item that holds a run's result and the reason `why`.

        The verdict "reproduced" sets `agrees` to "yes", and "not reproduced" to "no". Any other
        verdict becomes `agrees` unchanged.
        """
        return replace(
            self, reproduced=result.value, ci_low=result.low, ci_high=result.high, why=why,
            agrees={REPRODUCED: "yes", NOT_REPRODUCED: "no"}.get(verdict, verdict),
        )  # fmt: skip


def make_table(rows: Sequence[Item]) -> pd.DataFrame:
    """Make the table of published items: one row per item, the attributes of `Item` as columns.

    A further column `ratio` before `agrees` holds reproduced / published.
    """
    table = pd.DataFrame(rows)
    ratio = table["reproduced"] / table["published"]
    table.insert(list(table).index("agrees"), "ratio", ratio)
    return table


def statement_row(judged: JudgedStatement) -> Item:
    """Make the summary's row on a statement.

    A statement makes claims, and a claim consists of decisions, each of which compares a quantity
    with a threshold. The row's numbers are those of the decision that settles the verdict:
    `published` is the threshold, `reproduced` is the run's value.
    """
    settling = [claim for claim in judged.claims if claim.verdict == judged.verdict]
    worst = min((claim.deciding for claim in settling), key=lambda decision: decision.t)
    why = "; ".join(f"{claim.text}: {explain(claim)}" for claim in judged.claims)
    return Item(
        judged.name, "statement", worst.threshold, worst.value, worst.low, worst.high,
        agrees=judged.verdict, why=why,
    )  # fmt: skip


def number_rows(numbers: pd.DataFrame) -> Iterator[Item]:
    """Yield the summary's rows on published numbers, one row per number.

    `numbers` has the columns table, scheme, measure, published and why, and the keys of
    `compare_number`'s result.
    """
    rows: Any = numbers.itertuples(index=False)
    for row in rows:
        yield Item(
            f"table {row.table} {row.scheme} {row.measure}", "number", row.published,
            row.reproduced, row.ci_low, row.ci_high, lies_within_records(row), row.why,
        )  # fmt: skip


def distance_rows(numbers: pd.DataFrame, groups: Sequence[tuple[str, ...]]) -> Iterator[Item]:
    """Yield two rows for each group of schemes: how far the run is from the published numbers.

    The first row holds the median of |log2(reproduced / published)| over the group's numbers, the
    second row the 80th percentile.

    Parameters
    ----------
    numbers
        One row per published number. Columns scheme and log2, which is NaN if the run lacks the
        number.
    groups
        Groups of schemes. Nothing is published about a group, so there is nothing to agree with.
    """
    for schemes in groups:
        chosen = numbers[numbers["scheme"].isin(schemes)]
        distances = chosen["log2"].abs().dropna()
        for label, quantile in (("median", 0.5), ("80th percentile", 0.8)):
            with np.errstate(over="ignore", invalid="ignore"):  # the value 0 is infinitely far
                value = float(distances.quantile(quantile))
                factor = np.exp2(value)
            why = f"over {len(distances)} of {len(chosen)} numbers"
            if np.isfinite(value):
                why += f", a factor of {factor:.2f}"
            name = f"{label} |log2 ratio|, {', '.join(schemes)}"
            yield Item(name, "summary", reproduced=value, agrees="", why=why)


def fidelity_table(
    evidence: Evidence,
    numbers: pd.DataFrame,
    judged: Sequence[JudgedStatement],
    along_x: Sequence[JudgedStatement] = (),
) -> pd.DataFrame:
    """Make the table fidelity.csv, which compares a run with Ren et al. (2019).

    Parameters
    ----------
    evidence
        The results of the run.
    numbers
        The result of `numbers.compare_numbers`.
    judged
        The paper's statements F1 to F11 with their verdicts.
    along_x
        The statements that are judged in x alone too, with these verdicts.

    Returns
    -------
    DataFrame
        One row per item; columns as in `make_table`. The column `kind` says what
        the item is. "number": one of the 64 numbers of tables 6-9. "statement": one of F1 to F11;
        `published` is the threshold of the decision that settles the verdict, and `agrees` is the
        verdict. "boundary": the amplitude (m) at which HME1 and HME2 are equally good. "winner":
        the position MSE of a table's published winner divided by that of the best other scheme.
        "summary": a number on a whole table. A kind that ends with "x alone" has the MSE of x in
        place of x + y. Except for statements, `agrees` is yes, no, undecided or missing, or empty
        if nothing is published.
    """
    tables: Any = numbers.groupby("table")
    return make_table(
        [
            *number_rows(numbers),
            *(statement_row(statement) for statement in judged),
            *_boundaries(evidence, judged),
            *(_winner(evidence, number, table) for number, table in tables),
            *distance_rows(numbers, GROUPS),
            *(_ekf_ratio(evidence, number, table) for number, table in tables),
            *(_in_x(statement_row(statement)) for statement in along_x),
            *(_in_x(row) for row in _boundaries(evidence.along_x, along_x)),
        ]
    )


def _in_x(row: Item) -> Item:
    name = row.item.removesuffix(X_ALONE)
    return replace(row, item=f"{name}{X_ALONE}", kind=f"{row.kind}{X_ALONE}")


def _boundaries(evidence: Evidence, judged: Sequence[JudgedStatement]) -> list[Item]:
    """Make the rows on the boundary between HME1 and HME2, and on its growth with the period.

    The boundary is the amplitude at which both are equally good. If a boundary is published at a
    natural period, the run's boundary is compared with it. If the run has no boundary there, the
    verdict also rests on the MSEs at the amplitudes below and above the published boundary. The
    growth is the boundary (an amplitude) at 8 s divided by that at 4 s.
    """
    claims = {statement.name.removesuffix(X_ALONE): statement.claims for statement in judged}
    rows = []
    for period in (4.0, 6.0, 8.0):
        boundary = evidence.boundaries.get(period)
        row = Item(f"boundary {period:g} s", "boundary", BOUNDARIES.get(period, NAN))
        verdict, why = "", "not published"
        if period in BOUNDARIES:
            # if there is no boundary, the cells below and above the published boundary decide
            parts = claims[ON_BOUNDARY[period]]
            verdict = all_of(parts if boundary and boundary.wins else parts[:1])
            low, high = tolerated(period)
            why = f"agreement: within a factor of 2, {low:g} to {high:g} m"
        rows.append(_boundary_row(row, boundary, verdict, why))
    why = "the paper's boundary grows with the period; agreement: above 1"
    verdict = claims[ON_GROWTH][1].verdict
    rows.append(
        _boundary_row(Item("boundary 8 s / 4 s", "boundary"), evidence.growth, verdict, why)
    )
    return rows


def _boundary_row(row: Item, boundary: Estimate | None, verdict: str, why: str) -> Item:
    if boundary is None:
        return replace(row, agrees=verdict, why=NO_BOUNDARY)
    return row.judged(boundary, verdict, f"{boundary.label}; {why}")


def _winner(evidence: Evidence, number: int, table: pd.DataFrame) -> Item:
    """Make the row on the published winner of one table of Ren et al. (2019).

    The row's number is the winner's position MSE divided by that of the best other scheme. `number`
    is the number of the published table. `table` holds the rows of `numbers.compare_numbers` for
    this published table.
    """
    cell = TABLE_CELLS[number]
    chosen = table[table["measure"].isin(["x", "y"])]
    printed = chosen.groupby("scheme")["published"].sum().sort_values()
    winner = str(printed.index[0])
    why = f"print: {winner}, before {printed.index[1]}"
    row = Item(f"table {number} winner", "winner", float(printed.iloc[0] / printed.iloc[1]))
    best, rival = evidence.rank(cell), evidence.rank(cell, other_than=winner)
    if best is None or rival is None:
        return replace(row, why=f"{why}; ({cell}) or a scheme is not in this run")
    name, values = rival
    of_winner, of_other = (values[SCHEMES.index(scheme)] for scheme in (winner, name))
    decision = mean_ratio("", of_winner, of_other, 1.0, "below")
    why = f"{why}; here: {best[0]}; best other than {winner}: {name}"
    return row.judged(decision, JudgedClaim("", (decision,)).verdict, why)


def _ekf_ratio(evidence: Evidence, number: int, table: pd.DataFrame) -> Item:
    """Make the row on EKF's velocity MSE divided by its position MSE at one table's condition.

    This ratio shows at which frequency EKF's loop resonates. `number` is the number of the table in
    Ren et al. (2019). `table` holds the rows of `numbers.compare_numbers` for this published table.
    """
    cell = TABLE_CELLS[number]
    value = table[table["scheme"] == "EKF"].set_index("measure")["published"]
    published = float((value["vx"] + value["vy"]) / (value["x"] + value["y"]))
    why = f"at {cell}, in s^-2"
    if (table["printed"] != table["published"]).any():
        why += "; a misprint of the table is corrected"
    row = Item(f"EKF velocity / position MSE, table {number}", "summary", published, why=why)
    values = evidence.common([("EKF", cell, "velocity"), ("EKF", cell, "position")])
    if values is None:
        return row
    velocity, position = values
    with np.errstate(divide="ignore", invalid="ignore"):  # a perfect scheme has the position MSE 0
        place = place_print(published, published, velocity / position)
    why += f"; one record lies as far away with probability {place.chance:.2g}"
    return row.judged(mean_ratio("", velocity, position, published, ""), place.agrees, why)
