"""Decide on which side of a threshold a quantity lies, and whether the data show this.

The data show that a quantity lies on one side of the threshold if its whole 95 % interval lies on
this side. A claim consists of several such decisions; Holm's correction accounts for their number.
A statement makes several claims. Verdicts are told in words and in a table.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.statistics.inference import fieller, holm, p_value, t_quantile

REPRODUCED = "reproduced"
NOT_REPRODUCED = "not reproduced"
UNDECIDED = "undecided"
MISSING = "missing"

#: The side of a threshold on which a quantity is claimed to lie; "" where nothing is claimed.
Side = Literal["below", "above", ""]


@dataclass(frozen=True)
class Decision:
    """The comparison of one quantity with a threshold.

    label: What was compared and where, e.g. "4 s, 0.2 m, position".
    value, low, high: the quantity and the ends of its 95 % interval; NaN where unknown.
    threshold, side: the claim: the quantity lies below (or above) the threshold.
    t: Distance of the quantity from the threshold in standard errors, positive on the claimed side.
        If the standard error is zero: plus or minus infinity. If only the interval is known: plus
        or minus infinity if the threshold lies outside the interval, else 0.
    p: p-value of the two-sided test that the quantity equals the threshold. If only the interval is
        known: 0 if the threshold lies outside the interval, else 1.
    """

    label: str
    value: float
    low: float
    high: float
    threshold: float
    side: Side
    t: float
    p: float


#: The decision that stands where there is no data.
NOTHING = Decision("", np.nan, np.nan, np.nan, np.nan, "", -np.inf, 1.0)


def mean_ratio(label: str, a: Array, b: Array | float, threshold: float, side: Side) -> Decision:
    """Compare the ratio mean(a) / mean(b), paired over the replicates, with a threshold.

    "mean(a) / mean(b) < threshold" means "mean(a - threshold b) < 0", so the test is the paired t
    test of a - threshold b. The 95 % interval of the ratio is the set of thresholds that this test
    does not reject (Fieller 1954, Some problems in interval estimation). The interval starts at 0
    or above. Its ends are NaN for a single replicate, or if `b` scatters too much for a bounded
    interval. If the mean of `b` is 0, the ratio is infinite, or NaN if that of `a` is 0 too.

    `a` and `b` have the shape (replicates,), in the same order, and are not negative; `b` may be a
    number that is known exactly.
    """
    n = len(a)
    b = np.broadcast_to(np.asarray(b, dtype=float), (n,))
    with np.errstate(divide="ignore", over="ignore", invalid="ignore"):  # the mean of b may be 0
        ratio = float(np.mean(a) / np.mean(b))
    if n < 2:
        return Decision(label, ratio, np.nan, np.nan, threshold, side, 0.0, 1.0)
    difference = a - threshold * b
    error = float(np.std(difference, ddof=1) / np.sqrt(n))
    distance = float(np.mean(difference)) * (1.0 if side == "above" else -1.0)
    t = count_errors(distance, error)
    low, high = fieller(a, b, float(t_quantile(n - 1)))
    p = float(p_value(distance, error, n - 1))
    return Decision(label, ratio, low, high, threshold, side, t, p)


def count_errors(distance: float, error: float) -> float:
    """Return a distance in standard errors: infinite without an error, 0 if it is not known."""
    with np.errstate(divide="ignore", invalid="ignore"):
        return float(np.nan_to_num(np.divide(distance, error), posinf=np.inf, neginf=-np.inf))


@dataclass(frozen=True)
class Estimate:
    """A quantity with its 95 % interval, e.g. from a bootstrap; the ends are NaN if unknown."""

    label: str
    value: float
    low: float
    high: float

    def against(self, threshold: float, side: Side) -> Decision:
        """Decide by the 95 % interval alone whether the quantity lies below (or above) a threshold.

        If the interval is unknown or contains the threshold, the decision has t = 0 and p = 1.
        Otherwise it has p = 0, and t is plus infinity on the claimed side, minus infinity on the
        other side.
        """
        wholly_above, wholly_below = self.low > threshold, self.high < threshold
        t = 0.0
        if wholly_above or wholly_below:
            t = np.inf if wholly_above == (side == "above") else -np.inf
        p = 1.0 if t == 0.0 else 0.0
        return Decision(self.label, self.value, self.low, self.high, threshold, side, t, p)


@dataclass(frozen=True)
class JudgedClaim:
    """One claim of a paper, which is true if every one of its decisions holds.

    text: What is claimed, in words.
    decisions: the comparisons of the run's quantities with thresholds.
    missing: names of the data that the run lacks. A claim with missing data can be refuted, but not
        confirmed.
    """

    text: str
    decisions: tuple[Decision, ...]
    missing: tuple[str, ...] = ()

    @property
    def verdict(self) -> str:
        """The verdict, by Holm's step-down test over the decisions at a family-wise error of 5 %.

        "not reproduced" if the test shows that at least one decision fails; else "missing" if data
        are missing or there is no decision; else "reproduced" if the test shows that every decision
        holds; else "undecided".
        """
        rejected = holm([c.p for c in self.decisions])
        held = np.array([c.t > 0.0 for c in self.decisions], dtype=bool)
        if np.any(rejected & ~held):
            return NOT_REPRODUCED
        if self.missing or not self.decisions:
            return MISSING
        return REPRODUCED if np.all(rejected & held) else UNDECIDED

    @property
    def deciding(self) -> Decision:
        """The decision that supports the claim least (smallest `t`), or else `NOTHING`."""
        return min(self.decisions, key=lambda c: c.t, default=NOTHING)

    @property
    def holding(self) -> int:
        """The number of decisions whose value lies on the claimed side, whatever the interval."""
        return sum(
            c.value < c.threshold if c.side == "below" else c.value > c.threshold
            for c in self.decisions
        )


def all_of(claims: Sequence[JudgedClaim]) -> str:
    """Return the verdict on a statement that makes several claims: the worst verdict of the claims.

    From worst to best: "not reproduced", "missing", "undecided", "reproduced" (also without
    claims).
    """
    worst_first = (NOT_REPRODUCED, MISSING, UNDECIDED, REPRODUCED)
    return min((claim.verdict for claim in claims), key=worst_first.index, default=REPRODUCED)


@dataclass(frozen=True)
class JudgedStatement:
    """A statement of a paper and the run's verdict on the statement.

    `name`, `text`: e.g. "F1", and what the paper says. `definition`: the test of the statement in
    words, written before any run was judged.
    """

    name: str
    text: str
    definition: str
    claims: tuple[JudgedClaim, ...]

    @property
    def verdict(self) -> str:
        """The worst verdict of the statement's claims (`all_of`)."""
        return all_of(self.claims)


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
    """List missing items in words: the first four, and the number of the others."""
    named = [f"({item})" if "," in item else item for item in missing[:4]]
    return ", ".join(named) + (f" and {len(missing) - 4} more" if len(missing) > 4 else "")


def tabulate_claims(judged: list[JudgedStatement]) -> pd.DataFrame:
    """Make a table with one row per claim, which shows the claim's least favourable decision."""
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
