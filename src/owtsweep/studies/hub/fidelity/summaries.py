"""`fidelity.csv`: everything that the paper prints, one row each, with what the run says to it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from owtsweep.studies.hub.fidelity.boundaries import Boundary, ratio_of_boundaries, within
from owtsweep.studies.hub.fidelity.claims import BOUNDARY_TOLERANCE, boundary_claims
from owtsweep.studies.hub.fidelity.evidence import SCHEMES, Evidence, least
from owtsweep.studies.hub.fidelity.numbers import lies_within_records
from owtsweep.studies.hub.fidelity.score import BOUNDARIES, published_numbers
from owtsweep.studies.hub.fidelity.statements import TABLE_CELLS
from owtsweep.verdicts.inference import (
    MISSING,
    NOT_REPRODUCED,
    REPRODUCED,
    Claim,
    all_of,
    mean_ratio,
)
from owtsweep.verdicts.judgement import Judged

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = (
    "item", "kind", "published", "reproduced", "ci_low", "ci_high", "ratio", "agrees", "why",
)  # fmt: skip
#: Median |log2(reproduced / published)| that counts as agreement, by group of schemes.
GROUPS = {("MKF", "HME1", "HME2"): 0.45, ("EKF",): 1.2}
#: Where the velocity/position ratio of EKF's MSE counts as the print's.
EKF_RATIO = (0.45, 0.65)
AGREES = {REPRODUCED: "yes", NOT_REPRODUCED: "no"}
NAN = float("nan")


def fidelity_table(
    evidence: Evidence,
    numbers: pd.DataFrame,
    judged: Sequence[Judged],
    boundaries: Mapping[float, Boundary],
) -> pd.DataFrame:
    """All rows of fidelity.csv.

    Returns
    -------
    DataFrame
        `COLUMNS`. kind "number": the 64 of tables 6-9; "statement": F1-F11, `published` is the
        threshold of the comparison that settles the verdict and `agrees` the verdict; "boundary":
        HME1/HME2, m; "winner": position MSE of the published winner over that of the best other
        scheme; "summary": distances of whole tables. `agrees` elsewhere: yes, no, undecided,
        missing, or empty where nothing is published. ratio = reproduced / published.
    """
    import pandas as pd

    rows = [
        *_numbers(numbers),
        *(_statement(statement) for statement in judged),
        *_boundaries(evidence, boundaries),
        *(_winner(evidence, number) for number in TABLE_CELLS),
        *_distances(numbers),
        *(_ekf_ratio(evidence, number) for number in TABLE_CELLS),
    ]
    table = pd.DataFrame(rows, columns=list(COLUMNS))
    return table.assign(ratio=table["reproduced"] / table["published"])


def _numbers(numbers: pd.DataFrame) -> list[dict[str, Any]]:
    return [
        {
            "item": f"table {row.table} {row.scheme} {row.measure}",
            "kind": "number",
            "published": row.published,
            "reproduced": row.reproduced,
            "ci_low": row.ci_low,
            "ci_high": row.ci_high,
            "agrees": lies_within_records(row),
            "why": row.why,
        }
        for row in numbers.itertuples(index=False)
    ]


def _statement(judged: Judged) -> dict[str, Any]:
    worst = judged.settling.deciding
    return {
        "item": judged.name,
        "kind": "statement",
        "published": worst.threshold if worst else NAN,
        "reproduced": worst.value if worst else NAN,
        "ci_low": worst.low if worst else NAN,
        "ci_high": worst.high if worst else NAN,
        "agrees": judged.verdict,
        "why": judged.why,
    }


def _boundaries(evidence: Evidence, boundaries: Mapping[float, Boundary]) -> list[dict[str, Any]]:
    rows = []
    for period in (4.0, 6.0, 8.0):
        printed, found = BOUNDARIES.get(period, NAN), boundaries.get(period)
        agrees, why = "", "not published"
        if period in BOUNDARIES:
            low, high = printed / BOUNDARY_TOLERANCE, printed * BOUNDARY_TOLERANCE
            verdict = Claim("", within(found, low, high) if found else ()).verdict
            if found and found.wins:  # then the cells to either side decide
                verdict = all_of(boundary_claims(evidence, period, printed))
            agrees = AGREES.get(verdict, verdict)
            why = f"agreement: within a factor of 2, {low:g} to {high:g} m"
        rows.append(_boundary_row(f"boundary {period:g} s", printed, found, agrees, why))
    ratio = ratio_of_boundaries(evidence, 8.0, 4.0)
    claim = Claim("", (ratio.against(1.0, "above"),) if ratio else ())
    agrees = AGREES.get(claim.verdict, claim.verdict)
    why = "the paper's boundary grows with the period; agreement: above 1"
    rows.append(_boundary_row("boundary 8 s / 4 s", NAN, ratio, agrees, why))
    return rows


def _boundary_row(
    item: str, printed: float, found: Boundary | None, agrees: str, why: str
) -> dict[str, Any]:
    return {
        "item": item,
        "kind": "boundary",
        "published": printed,
        "reproduced": found.value if found else NAN,
        "ci_low": found.low if found else NAN,
        "ci_high": found.high if found else NAN,
        "agrees": agrees,
        "why": f"{found.label}; {why}"
        if found
        else "period, scheme or superposed cases not in this run",
    }


def _winner(evidence: Evidence, number: int) -> dict[str, Any]:
    """The published winner's position MSE over that of the best of the others, here and there."""
    cell = TABLE_CELLS[number]
    table = published_numbers()
    chosen = table[(table["table"] == number) & table["measure"].isin(["x", "y"])]
    printed = chosen.groupby("scheme")["published"].sum().sort_values()
    winner = str(printed.index[0])
    row = {
        "item": f"table {number} winner",
        "kind": "winner",
        "published": float(printed.iloc[0] / printed.iloc[1]),
        "reproduced": NAN,
        "ci_low": NAN,
        "ci_high": NAN,
        "agrees": MISSING,
        "why": f"print: {winner}, before {printed.index[1]}",
    }
    found, means = evidence.best_other(winner, cell), evidence.paired(SCHEMES, cell)
    if found is None or means is None:
        return row | {"why": f"{row['why']}; ({cell}) or a scheme is not in this run"}
    name, own, other = found
    against = mean_ratio("", own, other, 1.0, "below")
    verdict = Claim("", (against,)).verdict
    return row | {
        "reproduced": against.value,
        "ci_low": against.low,
        "ci_high": against.high,
        "agrees": AGREES.get(verdict, verdict),
        "why": f"{row['why']}; here: {least(means)}; best other than {winner}: {name}",
    }


def _distances(numbers: pd.DataFrame) -> list[dict[str, Any]]:
    rows = []
    for schemes, goal in GROUPS.items():
        chosen = numbers[numbers["scheme"].isin(schemes)]
        distances = chosen["log2"].abs().dropna()
        name = ", ".join(schemes)
        size = f"{len(distances)} of {len(chosen)} numbers"
        for label, quantile, goal_of in (("median", 0.5, goal), ("80th percentile", 0.8, NAN)):
            value = float(distances.quantile(quantile)) if len(distances) else NAN
            # With numbers missing this is the distance of another set of numbers.
            agrees = (
                MISSING if len(distances) < len(chosen) else "yes" if value <= goal_of else "no"
            )
            rows.append(
                {
                    "item": f"{label} |log2 ratio|, {name}",
                    "kind": "summary",
                    "published": NAN,
                    "reproduced": value,
                    "ci_low": NAN,
                    "ci_high": NAN,
                    "agrees": agrees if np.isfinite(goal_of) else "",
                    "why": _distance_text(size, value, goal_of),
                }
            )
    return rows


def _distance_text(size: str, value: float, goal: float) -> str:
    factor = f", a factor of {2.0**value:.2f}" if np.isfinite(value) else ""
    agreement = f"; agreement: at most {goal:g}" if np.isfinite(goal) else ""
    return f"over {size}{factor}{agreement}"


def _ekf_ratio(evidence: Evidence, number: int) -> dict[str, Any]:
    """Velocity MSE over position MSE of EKF: where its loop resonates."""
    cell, (low, high) = TABLE_CELLS[number], EKF_RATIO
    table = published_numbers()
    chosen = table[(table["table"] == number) & (table["scheme"] == "EKF")]
    value = chosen.set_index("measure")["published"]
    row = {
        "item": f"EKF velocity / position MSE, table {number}",
        "kind": "summary",
        "published": float((value["vx"] + value["vy"]) / (value["x"] + value["y"])),
        "reproduced": NAN,
        "ci_low": NAN,
        "ci_high": NAN,
        "agrees": MISSING,
        "why": f"at {cell}, in s^-2; agreement: within {low:g} to {high:g}",
    }
    found = evidence.common([("EKF", cell, "velocity"), ("EKF", cell, "position")])
    if found is None:
        return row
    velocity, position = found
    bounds = (
        mean_ratio("", velocity, position, low, "above"),
        mean_ratio("", velocity, position, high, "below"),
    )
    verdict = Claim("", bounds).verdict
    return row | {
        "reproduced": bounds[0].value,
        "ci_low": bounds[0].low,
        "ci_high": bounds[0].high,
        "agrees": AGREES.get(verdict, verdict),
    }
