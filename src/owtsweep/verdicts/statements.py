"""Judged statements: their verdicts, the verdicts in words, and tables of them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.verdicts.inference import Decision, JudgedClaim, all_of

if TYPE_CHECKING:
    import pandas as pd


@dataclass(frozen=True)
class JudgedStatement:
    """A statement of a paper and the run's verdict on the statement.

    Attributes
    ----------
    name
        Short name of the statement, e.g. "F1".
    text
        What the paper says.
    definition
        The test of the statement in words, written before any run was judged.
    claims
        The claims that the statement makes.
    """

    name: str
    text: str
    definition: str
    claims: tuple[JudgedClaim, ...]

    @property
    def verdict(self) -> str:
        """The verdict on the statement, which is the worst verdict of its claims.

        From worst to best: "not reproduced", "missing", "undecided", "reproduced".
        """
        return all_of(self.claims)

    @property
    def settling(self) -> JudgedClaim:
        """The claim that the data support least, among claims with the statement's verdict."""
        chosen = [claim for claim in self.claims if claim.verdict == self.verdict]
        return min(chosen, key=lambda claim: claim.deciding.t)

    @property
    def why(self) -> str:
        """The verdicts of all claims and the numbers that decide them, in one line."""
        return "; ".join(f"{claim.text}: {explain(claim)}" for claim in self.claims)


def explain(claim: JudgedClaim) -> str:
    """Explain a claim in one line: its verdict, its least favourable decision, and missing data."""
    parts = [claim.verdict]
    if claim.decisions:
        parts.append(f"{claim.holding} of {len(claim.decisions)} hold in the mean")
        parts.append(describe(claim.deciding))
    if claim.missing:
        parts.append(f"{name_missing(claim.missing)} missing")
    return ", ".join(parts)


def describe(decision: Decision) -> str:
    """Describe a decision in words and numbers: label, value, 95 % interval, and the claim."""
    claimed = f"to be {decision.side} {decision.threshold:.3g}"
    if np.isnan(decision.value):
        return f"{decision.label}, {claimed}"
    interval = f"[{decision.low:.3g}, {decision.high:.3g}]"
    if np.isnan(decision.low):
        interval = f"(t = {decision.t:.2g}, no bounded interval)"
    return f"{decision.label} {decision.value:.3g} {interval}, {claimed}"


def name_missing(missing: tuple[str, ...]) -> str:
    """List missing items in words.

    If there are more than four items, the first four are listed and the others are counted.
    """
    named = [f"({item})" if "," in item else item for item in missing[:4]]
    return ", ".join(named) + (f" and {len(missing) - 4} more" if len(missing) > 4 else "")


def tabulate_claims(judged: list[JudgedStatement]) -> pd.DataFrame:
    """Make a table with one row per claim, which shows the claim's least favourable decision."""
    import pandas as pd

    return pd.DataFrame(
        {
            "statement": statement.name,
            "claim": claim.text,
            "verdict": claim.verdict,
            "decided_at": claim.deciding.label,
            "value": claim.deciding.value,
            "ci_low": claim.deciding.low,
            "ci_high": claim.deciding.high,
            "side": claim.deciding.side,
            "threshold": claim.deciding.threshold,
            "holding": claim.holding,
            "comparisons": len(claim.decisions),
            "missing": "; ".join(claim.missing),
        }
        for statement in judged
        for claim in statement.claims
    )
