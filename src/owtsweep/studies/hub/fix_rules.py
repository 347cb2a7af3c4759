"""How far a scheme trusts a position fix: always, only inside a gate, or less far out (Huber)."""

from __future__ import annotations

import math
from statistics import NormalDist

from owtsweep.estimation.weighing import Weighing
from owtsweep.studies.hub.scheme_sections import FixTuning

#: All fixes count alike.
PLAIN = Weighing(math.inf, False, 0)


def make_fix_rule(tuning: FixTuning, name: str | None = None, axes: int = 2) -> Weighing:
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
        return Weighing(limit, False, tuning.gate_patience)
    return Weighing(tuning.huber_limit, True, 0) if name == "huber" else PLAIN
