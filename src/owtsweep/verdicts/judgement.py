"""The verdicts on F1-F11 as tables."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from owtsweep.studies.hub import published
from owtsweep.studies.hub.fidelity.evidence import Evidence
from owtsweep.studies.hub.fidelity.history_statements import HISTORY_STATEMENTS
from owtsweep.studies.hub.fidelity.statements import STATEMENTS
from owtsweep.verdicts.inference import Claim, Comparison, all_of, settling

if TYPE_CHECKING:
    import pandas as pd

CLAIM_COLUMNS = (
    "statement", "claim", "verdict", "decided_at", "value", "ci_low", "ci_high", "side",
    "threshold", "holding", "comparisons", "missing",
)  # fmt: skip


@dataclass(frozen=True)
class Judged:
    """A statement of the paper and what the run says to it.

    Attributes
    ----------
    name
        F1 to F11.
    text
        What the paper says.
    definition
        The test, as written down before judging.
    claims
        What the statement asserts, one by one.
    """

    name: str
    text: str
    definition: str
    claims: tuple[Claim, ...]

    @property
    def verdict(self) -> str:
        """reproduced, not reproduced, undecided or missing."""
        return all_of(self.claims)

    @property
    def settling(self) -> Claim:
        """The claim that settles the verdict."""
        return settling(self.claims)

    @property
    def why(self) -> str:
        """The verdict in numbers, one line."""
        return "; ".join(f"{claim.text}: {explain(claim)}" for claim in self.claims)


def judge(evidence: Evidence) -> list[Judged]:
    """All statements in their order."""
    tests = {**STATEMENTS, **HISTORY_STATEMENTS}
    facts = published.facts().set_index("id")["statement"]
    return [
        Judged(name, str(text), definition_of(tests[name]), tuple(tests[name](evidence)))
        for name, text in facts.items()
        if isinstance(name, str)
    ]


def definition_of(test: Callable[[Evidence], list[Claim]]) -> str:
    """A test's docstring in one line."""
    return " ".join((inspect.getdoc(test) or "").split())


def explain(claim: Claim) -> str:
    """A claim's verdict and the comparison that decides it."""
    parts = [claim.verdict]
    if claim.deciding is not None:
        parts.append(f"{_holding(claim)} of {len(claim.comparisons)} hold in the mean")
        parts.append(describe(claim.deciding))
    if claim.missing:
        parts.append(f"{missing_text(claim.missing)} missing")
    return ", ".join(parts)


def describe(comparison: Comparison) -> str:
    """A comparison in words and numbers."""
    claimed = f"to be {comparison.side} {comparison.threshold:.3g}"
    if np.isnan(comparison.value):
        return f"{comparison.label}, {claimed}"
    interval = f"[{comparison.low:.3g}, {comparison.high:.3g}]"
    if np.isnan(comparison.low):
        interval = f"(t = {comparison.t:.2g}, no bounded interval)"
    return f"{comparison.label} {comparison.value:.3g} {interval}, {claimed}"


def missing_text(missing: tuple[str, ...], most: int = 4) -> str:
    """What is missing, not all of it when that is much."""
    named = [f"({item})" if "," in item else item for item in missing[:most]]
    more = f" and {len(missing) - most} more" if len(missing) > most else ""
    return ", ".join(named) + more


def claims_table(judged: list[Judged]) -> pd.DataFrame:
    """One row per claim, with the comparison that is furthest from holding."""
    import pandas as pd

    rows = []
    for statement in judged:
        for claim in statement.claims:
            worst = claim.deciding
            nan = float("nan")
            rows.append(
                {
                    "statement": statement.name,
                    "claim": claim.text,
                    "verdict": claim.verdict,
                    "decided_at": worst.label if worst else "",
                    "value": worst.value if worst else nan,
                    "ci_low": worst.low if worst else nan,
                    "ci_high": worst.high if worst else nan,
                    "side": worst.side if worst else "",
                    "threshold": worst.threshold if worst else nan,
                    "holding": _holding(claim),
                    "comparisons": len(claim.comparisons),
                    "missing": "; ".join(claim.missing),
                }
            )
    return pd.DataFrame(rows, columns=list(CLAIM_COLUMNS))


def _holding(claim: Claim) -> int:
    """How many comparisons lie on the claimed side, whatever their intervals say."""
    return sum(
        c.value < c.threshold if c.side == "below" else c.value > c.threshold
        for c in claim.comparisons
    )
