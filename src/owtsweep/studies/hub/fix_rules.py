"""How far a scheme trusts a position fix: always, only inside a gate, or less far out (Huber)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

from owtsweep.studies.hub.scheme_sections import FixTuning

#: Values of the key `fix_rule`; the kernels use the index.
FIX_RULES = ("plain", "gate", "huber")


@dataclass(frozen=True)
class FixRule:
    """The rule by which the distance of a fix from its prediction decides on the fix's weight.

    name: one of `FIX_RULES`.
    limit: the distance, in standard deviations, beyond which a fix loses weight. With a gate, the
        weight beyond is 0; with Huber's rule it is limit / distance (Huber 1964).
    patience: number of fixes that a gate refuses in a row. Further fixes are taken, whatever their
        distance, until one lies within the limit: so many outliers in a row are less likely than
        that the state is wrong.
    """

    name: str = "plain"
    limit: float = math.inf
    patience: int = 0

    def weigh(self, distance: float, beyond: int = 1) -> float:
        """Return the weight of a fix, from 0 to 1, by its distance in standard deviations.

        `beyond` is how many fixes in a row, with this one, lie beyond the limit.
        """
        if self.name == "plain" or distance <= self.limit:
            return 1.0
        if self.name == "gate":
            return 0.0 if beyond <= self.patience else 1.0
        return self.limit / distance


#: All fixes count alike.
PLAIN = FixRule()


class FixJudge:
    """Weighs fix after fix by a rule, and counts how many in a row lie beyond the rule's limit."""

    def __init__(self, rule: FixRule) -> None:
        self.rule, self.beyond = rule, 0

    def weigh(self, distance: float) -> float:
        """Return the weight of the next fix for its distance in standard deviations."""
        self.beyond = self.beyond + 1 if distance > self.rule.limit else 0
        return self.rule.weigh(distance, self.beyond)


def make_fix_rule(tuning: FixTuning, name: str | None = None, axes: int = 2) -> FixRule:
    """Return the rule that a filter's tuning asks for.

    The limit of a gate is the quantile of the chi distribution, with a degree of freedom per axis,
    at the key `gate_probability` (Bar-Shalom, Li and Kirubarajan 2001, section 5.4).

    name: the rule; None: the key `fix_rule`.
    axes: number of axes of which a fix is judged at once, 1 or 2.
    """
    name = name or tuning.fix_rule
    if name == "gate":
        if axes == 1:
            limit = NormalDist().inv_cdf(0.5 + 0.5 * tuning.gate_probability)
        else:
            limit = math.sqrt(-2.0 * math.log1p(-tuning.gate_probability))
        return FixRule("gate", limit, tuning.gate_patience)
    if name == "huber":
        return FixRule("huber", tuning.huber_limit)
    return FixRule()
