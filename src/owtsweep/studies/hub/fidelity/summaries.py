"""`fidelity.csv`: one row per published item, with the run's result for it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

from owtsweep.studies.hub.fidelity.boundaries import (
    PUBLISHED,
    Boundary,
    boundary_claims,
    claim_within,
    ratio_of_boundaries,
    tolerated,
)
from owtsweep.studies.hub.fidelity.evidence import SCHEMES, Evidence
from owtsweep.studies.hub.fidelity.score import published_numbers
from owtsweep.studies.hub.fidelity.statements import TABLE_CELLS
from owtsweep.verdicts.evidence import find_best
from owtsweep.verdicts.inference import Claim, all_of, mean_ratio
from owtsweep.verdicts.statements import JudgedStatement
from owtsweep.verdicts.summary import (
    NAN,
    Item,
    agreement,
    distance_rows,
    make_table,
    number_rows,
    statement_row,
)

if TYPE_CHECKING:
    import pandas as pd

#: Group of schemes -> greatest median |log2(reproduced / published)| that counts as agreement.
GROUPS = {("MKF", "HME1", "HME2"): 0.45, ("EKF",): 1.2}
#: The range in which the velocity/position ratio of EKF's MSE agrees with the paper.
EKF_RATIO = (0.45, 0.65)
NO_BOUNDARY = "period, scheme or superposed cases not in this run"


def fidelity_table(
    evidence: Evidence,
    numbers: pd.DataFrame,
    judged: Sequence[JudgedStatement],
    boundaries: Mapping[float, Boundary],
) -> pd.DataFrame:
    """All rows of fidelity.csv.

    Returns
    -------
    DataFrame
        `verdicts.summary.COLUMNS`. kind "number": the 64 of tables 6-9; "statement": F1-F11,
        `published` is the threshold of the decision that settles the verdict and `agrees` the
        verdict; "boundary": HME1/HME2, m; "winner": position MSE of the published winner over that
        of the best other scheme; "summary": distances of whole tables. `agrees` elsewhere: yes, no,
        undecided, missing, or empty where nothing is published. ratio = reproduced / published.
    """
    return make_table(
        [
            *number_rows(numbers),
            *(statement_row(statement) for statement in judged),
            *(_boundary(evidence, boundaries, period) for period in (4.0, 6.0, 8.0)),
            _growth(evidence),
            *(_winner(evidence, number) for number in TABLE_CELLS),
            *distance_rows(numbers, GROUPS),
            *(_ekf_ratio(evidence, number) for number in TABLE_CELLS),
        ]
    )


def _boundary(evidence: Evidence, boundaries: Mapping[float, Boundary], period: float) -> Item:
    """The boundary at one period (s) against the published one, if there is one."""
    at_period = boundaries.get(period)
    if period not in PUBLISHED:
        return _boundary_row(f"boundary {period:g} s", NAN, at_period, "", "not published")
    low, high = tolerated(period)
    verdict = claim_within("", at_period, period).verdict
    if at_period and at_period.wins:  # then the cells on either side decide
        verdict = all_of(boundary_claims(evidence, period))
    why = f"agreement: within a factor of 2, {low:g} to {high:g} m"
    item = f"boundary {period:g} s"
    return _boundary_row(item, PUBLISHED[period], at_period, agreement(verdict), why)


def _growth(evidence: Evidence) -> Item:
    """The boundary at 8 s over that at 4 s."""
    ratio = ratio_of_boundaries(evidence, 8.0, 4.0)
    claim = Claim("", (ratio.against(1.0, "above"),) if ratio else ())
    why = "the paper's boundary grows with the period; agreement: above 1"
    return _boundary_row("boundary 8 s / 4 s", NAN, ratio, agreement(claim.verdict), why)


def _boundary_row(
    item: str, published: float, boundary: Boundary | None, agrees: str, why: str
) -> Item:
    row = Item(item, "boundary", published, agrees=agrees, why=NO_BOUNDARY)
    if boundary is None:
        return row
    return replace(
        row, reproduced=boundary.value, ci_low=boundary.low, ci_high=boundary.high,
        why=f"{boundary.label}; {why}",
    )  # fmt: skip


def _winner(evidence: Evidence, number: int) -> Item:
    """The published winner's position MSE over that of the best other scheme, in run and paper."""
    cell = TABLE_CELLS[number]
    table = published_numbers()
    chosen = table[(table["table"] == number) & table["measure"].isin(["x", "y"])]
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
    return replace(row, why=why).decided(decision, agreement(Claim("", (decision,)).verdict))


def _ekf_ratio(evidence: Evidence, number: int) -> Item:
    """Velocity MSE over position MSE of EKF, which shows where in frequency its loop resonates."""
    cell, (low, high) = TABLE_CELLS[number], EKF_RATIO
    table = published_numbers()
    chosen = table[(table["table"] == number) & (table["scheme"] == "EKF")]
    value = chosen.set_index("measure")["published"]
    row = Item(
        item=f"EKF velocity / position MSE, table {number}",
        kind="summary",
        published=float((value["vx"] + value["vy"]) / (value["x"] + value["y"])),
        why=f"at {cell}, in s^-2; agreement: within {low:g} to {high:g}",
    )
    values = evidence.common([("EKF", cell, "velocity"), ("EKF", cell, "position")])
    if values is None:
        return row
    velocity, position = values
    decisions = (
        mean_ratio("", velocity, position, low, "above"),
        mean_ratio("", velocity, position, high, "below"),
    )
    return row.decided(decisions[0], agreement(Claim("", decisions).verdict))
