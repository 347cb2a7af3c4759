"""Make the table fidelity.csv, which compares a run with the published results of the paper.

The paper is Ren et al. (2019). The table has one row per published item.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

from owtsweep.studies.hub.fidelity import boundaries
from owtsweep.studies.hub.fidelity.evidence import SCHEMES, HubEvidence
from owtsweep.studies.hub.fidelity.statements import TABLE_CELLS, X_ALONE
from owtsweep.verdicts import summary
from owtsweep.verdicts.evidence import find_best
from owtsweep.verdicts.inference import Claim, Estimate, all_of, mean_ratio
from owtsweep.verdicts.statements import JudgedStatement
from owtsweep.verdicts.summary import NAN, Item

if TYPE_CHECKING:
    import pandas as pd

#: Group of schemes -> greatest median |log2(reproduced / published)| that counts as agreement.
GROUPS = {("MKF", "HME1", "HME2"): 0.45, ("EKF",): 1.2}
#: The range of EKF's velocity MSE / position MSE (s^-2) that agrees with the paper.
EKF_RATIO = (0.45, 0.65)
NO_BOUNDARY = "period, scheme or superposed cases not in this run"


def fidelity_table(
    evidence: HubEvidence,
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
        One row per item; columns as in `verdicts.summary.make_table`. The column `kind` says what
        the item is. "number": one of the 64 numbers of tables 6-9. "statement": one of F1 to F11;
        `published` is the threshold of the decision that settles the verdict, and `agrees` is the
        verdict. "boundary": the amplitude (m) at which HME1 and HME2 are equally good. "winner":
        the position MSE of a table's published winner divided by that of the best other scheme.
        "summary": a number on a whole table. A kind that ends with "x alone" has the MSE of x in
        place of x + y. Except for statements, `agrees` is yes, no, undecided or missing, or empty
        if nothing is published.
    """
    tables: Any = numbers.groupby("table")
    return summary.make_table(
        [
            *summary.number_rows(numbers),
            *(summary.statement_row(statement) for statement in judged),
            *(_boundary(evidence, period) for period in (4.0, 6.0, 8.0)),
            _growth(evidence),
            *(_winner(evidence, number, table) for number, table in tables),
            *summary.distance_rows(numbers, GROUPS),
            *(_ekf_ratio(evidence, number, table) for number, table in tables),
            *(_in_x(summary.statement_row(statement)) for statement in along_x),
            *(_in_x(_boundary(evidence.along_x, period)) for period in (4.0, 6.0, 8.0)),
            _in_x(_growth(evidence.along_x)),
        ]
    )


def _in_x(row: Item) -> Item:
    name = row.item.removesuffix(X_ALONE)
    return replace(row, item=f"{name}{X_ALONE}", kind=f"{row.kind}{X_ALONE}")


def _boundary(evidence: HubEvidence, period: float) -> Item:
    """Make the row on the boundary between HME1 and HME2 at a natural period (s).

    The boundary is the amplitude at which both are equally good. If a boundary is published at this
    period, the run's boundary is compared with it. If the run has no boundary at such a period, the
    verdict also rests on the MSEs at the amplitudes below and above the published boundary.
    """
    boundary = evidence.boundaries.get(period)
    row = Item(f"boundary {period:g} s", "boundary", boundaries.PUBLISHED.get(period, NAN))
    if period not in boundaries.PUBLISHED:
        return _boundary_row(row, boundary, "", "not published")
    claims = boundaries.boundary_claims(evidence, period)
    # if there is no boundary, the cells below and above the published boundary decide
    verdict = all_of(claims if boundary and boundary.wins else claims[:1])
    low, high = boundaries.tolerated(period)
    why = f"agreement: within a factor of 2, {low:g} to {high:g} m"
    return _boundary_row(row, boundary, verdict, why)


def _growth(evidence: HubEvidence) -> Item:
    """Make the row on the growth of the boundary between HME1 and HME2 with the natural period.

    The row's number is the boundary (an amplitude) at 8 s divided by the boundary at 4 s.
    """
    why = "the paper's boundary grows with the period; agreement: above 1"
    row = Item("boundary 8 s / 4 s", "boundary")
    return _boundary_row(row, evidence.growth, boundaries.claim_growth(evidence).verdict, why)


def _boundary_row(row: Item, boundary: Estimate | None, verdict: str, why: str) -> Item:
    if boundary is None:
        return replace(row, agrees=verdict, why=NO_BOUNDARY)
    return row.judged(boundary, verdict, f"{boundary.label}; {why}")


def _winner(evidence: HubEvidence, number: int, table: pd.DataFrame) -> Item:
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
    rivals, means = evidence.best_other(winner, cell), evidence.paired(SCHEMES, cell)
    if rivals is None or means is None:
        return replace(row, why=f"{why}; ({cell}) or a scheme is not in this run")
    name, of_winner, of_other = rivals
    decision = mean_ratio("", of_winner, of_other, 1.0, "below")
    why = f"{why}; here: {find_best(means)}; best other than {winner}: {name}"
    return row.judged(decision, Claim("", (decision,)).verdict, why)


def _ekf_ratio(evidence: HubEvidence, number: int, table: pd.DataFrame) -> Item:
    """Make the row on EKF's velocity MSE divided by its position MSE at one table's condition.

    This ratio shows at which frequency EKF's loop resonates. `number` is the number of the table in
    Ren et al. (2019). `table` holds the rows of `numbers.compare_numbers` for this published table.
    """
    cell, (low, high) = TABLE_CELLS[number], EKF_RATIO
    value = table[table["scheme"] == "EKF"].set_index("measure")["published"]
    published = float((value["vx"] + value["vy"]) / (value["x"] + value["y"]))
    why = f"at {cell}, in s^-2; agreement: within {low:g} to {high:g}"
    if (table["printed"] != table["published"]).any():
        why += "; a misprint of the table is corrected"
    row = Item(f"EKF velocity / position MSE, table {number}", "summary", published, why=why)
    values = evidence.common([("EKF", cell, "velocity"), ("EKF", cell, "position")])
    if values is None:
        return row
    velocity, position = values
    decisions = (
        mean_ratio("", velocity, position, low, "above"),
        mean_ratio("", velocity, position, high, "below"),
    )
    return row.judged(decisions[0], Claim("", decisions).verdict, why)
