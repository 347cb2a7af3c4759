"""Statements of a paper: their tests, their verdicts, and a table of the verdicts."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from owtsweep.verdicts.inference import Claim, Decision, all_of

if TYPE_CHECKING:
    import pandas as pd

#: The object from which a study's tests read a run's values.
Evidence = TypeVar("Evidence")


@dataclass(frozen=True)
class JudgedStatement:
    """A statement of the paper and the run's verdict on it.

    Attributes
    ----------
    name
        Its name, e.g. F1.
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
        """The claim that determines the verdict; if all claims hold, the least certain one."""
        chosen = [claim for claim in self.claims if claim.verdict == self.verdict]
        return min(chosen, key=lambda c: c.deciding.t if c.deciding else -np.inf)

    @property
    def why(self) -> str:
        """The verdict in numbers, one line."""
        return "; ".join(f"{claim.text}: {explain(claim)}" for claim in self.claims)


def judge(
    texts: Mapping[str, str],
    tests: Mapping[str, Callable[[Evidence], list[Claim]]],
    evidence: Evidence,
) -> list[JudgedStatement]:
    """All statements in their order.

    Parameters
    ----------
    texts
        Name of a statement -> what the paper says.
    tests
        Name of a statement -> its test, a function that returns the claims about a run. The
        docstring of a test is its definition.
    evidence
        The argument of the tests.
    """
    judged = []
    for name, text in texts.items():
        definition = " ".join((inspect.getdoc(tests[name]) or "").split())
        judged.append(JudgedStatement(name, text, definition, tuple(tests[name](evidence))))
    return judged


def explain(claim: Claim) -> str:
    """A claim's verdict and the decision that settles it."""
    parts = [claim.verdict]
    if claim.deciding is not None:
        parts.append(f"{_count_holding(claim)} of {len(claim.decisions)} hold in the mean")
        parts.append(describe(claim.deciding))
    if claim.missing:
        parts.append(f"{name_missing(claim.missing)} missing")
    return ", ".join(parts)


def describe(decision: Decision) -> str:
    """A decision in words and numbers."""
    claimed = f"to be {decision.side} {decision.threshold:.3g}"
    if np.isnan(decision.value):
        return f"{decision.label}, {claimed}"
    interval = f"[{decision.low:.3g}, {decision.high:.3g}]"
    if np.isnan(decision.low):
        interval = f"(t = {decision.t:.2g}, no bounded interval)"
    return f"{decision.label} {decision.value:.3g} {interval}, {claimed}"


def name_missing(missing: tuple[str, ...], most: int = 4) -> str:
    """Name what is missing; a long list is shortened."""
    named = [f"({item})" if "," in item else item for item in missing[:most]]
    more = f" and {len(missing) - most} more" if len(missing) > most else ""
    return ", ".join(named) + more


def tabulate_claims(judged: list[JudgedStatement]) -> pd.DataFrame:
    """One row per claim, with the decision that supports the claim least."""
    import pandas as pd

    rows = []
    for statement in judged:
        for claim in statement.claims:
            worst, nan = claim.deciding, float("nan")
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
                    "holding": _count_holding(claim),
                    "comparisons": len(claim.decisions),
                    "missing": "; ".join(claim.missing),
                }
            )
    return pd.DataFrame(rows)


def _count_holding(claim: Claim) -> int:
    """The number of decisions whose value is on the claimed side, regardless of their intervals."""
    return sum(
        c.value < c.threshold if c.side == "below" else c.value > c.threshold
        for c in claim.decisions
    )
