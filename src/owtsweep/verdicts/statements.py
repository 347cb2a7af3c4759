"""Statements of a paper: their tests, their verdicts, and a table of the verdicts."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from owtsweep.verdicts.evidence import Evidence
from owtsweep.verdicts.inference import Claim, Decision, all_of

if TYPE_CHECKING:
    import pandas as pd

#: The evidence that a study's tests read.
OfStudy = TypeVar("OfStudy", bound=Evidence)


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
        return min(chosen, key=lambda claim: claim.deciding.t)

    @property
    def why(self) -> str:
        """The verdict in numbers, one line."""
        return "; ".join(f"{claim.text}: {explain(claim)}" for claim in self.claims)


def judge(
    texts: Mapping[str, str],
    tests: Mapping[str, Callable[[OfStudy], list[Claim]]],
    evidence: OfStudy,
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
    if claim.decisions:
        parts.append(f"{claim.holding} of {len(claim.decisions)} hold in the mean")
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


def name_missing(missing: tuple[str, ...]) -> str:
    """Name what is missing; of a long list the first four."""
    named = [f"({item})" if "," in item else item for item in missing[:4]]
    return ", ".join(named) + (f" and {len(missing) - 4} more" if len(missing) > 4 else "")


def tabulate_claims(judged: list[JudgedStatement]) -> pd.DataFrame:
    """One row per claim, with the decision that supports the claim least."""
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
