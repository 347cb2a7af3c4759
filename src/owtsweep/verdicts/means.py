"""Claims about means over records: at every place, the mean lies on one side of a threshold."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from owtsweep.arrays import Array
from owtsweep.verdicts.claims import gather
from owtsweep.verdicts.inference import Claim, Decision, Side, mean_ratio


def claim_means(
    text: str, parts: Iterable[tuple[str, Array | None]], side: Side, threshold: float
) -> Claim:
    """Claim that the mean of values lies below (above) a threshold at all places.

    Parameters
    ----------
    text
        What is claimed, in words.
    parts
        Pairs of a place's name and its values, one per record, not negative; None, or values that
        are not finite, where there is no datum.
    side, threshold
        The claim.
    """
    return gather(text, ((name, _compare(name, each, side, threshold)) for name, each in parts))


def _compare(name: str, values: Array | None, side: Side, threshold: float) -> Decision | None:
    if values is None or len(values) == 0 or not np.all(np.isfinite(values)):
        return None
    return mean_ratio(name, values, 1.0, threshold, side)
