"""Make claims that one scheme's errors are smaller (or larger) than those of another scheme."""

from __future__ import annotations

from collections.abc import Iterable

from owtsweep.verdicts.inference import Claim, Decision


def gather(text: str, parts: Iterable[tuple[str, Decision | None]]) -> Claim:
    """Combine decisions made at many places, e.g. at cells of a grid, into one claim.

    Parameters
    ----------
    text
        What is claimed, in words.
    parts
        Pairs of a place's name and the run's decision there; the decision is None where the run
        lacks the data. A place may occur several times. The names of places without a decision
        become the claim's `missing`, each name once.
    """
    decisions, missing = [], []
    for name, decision in parts:
        if decision is not None:
            decisions.append(decision)
        elif name not in missing:
            missing.append(name)
    return Claim(text, tuple(decisions), tuple(missing))
