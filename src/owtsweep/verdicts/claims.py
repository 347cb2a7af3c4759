"""Claims that many studies make: the errors of one scheme compared with those of another."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from owtsweep.verdicts.evidence import Cell, Evidence
from owtsweep.verdicts.inference import Claim, Decision, Estimate, Side, mean_ratio


def gather(text: str, parts: Iterable[tuple[str, Decision | None]]) -> Claim:
    """Combine decisions in many places into one claim.

    Parameters
    ----------
    text
        What is asserted, in words.
    parts
        Name of a place, and the run's decision there; None where it lacks the data. A place may
        have several decisions.
    """
    decisions, missing = [], []
    for name, decision in parts:
        if decision is not None:
            decisions.append(decision)
        elif name not in missing:
            missing.append(name)
    return Claim(text, tuple(decisions), tuple(missing))


def claim_estimate(
    text: str, name: str, estimate: Estimate | None, thresholds: Mapping[Side, float]
) -> Claim:
    """Compare an estimate with thresholds by side; without an estimate, `name` is missing."""
    if estimate is None:
        return Claim(text, (), (name,))
    return Claim(text, tuple(estimate.against(limit, side) for side, limit in thresholds.items()))


def claim_against_best(
    text: str, evidence: Evidence, scheme: str, cells: Sequence[Cell], side: Side
) -> Claim:
    """Compare the ratio of a scheme's mean error to the best other scheme's with 1 in all cells."""

    def decide(cell: Cell) -> Decision | None:
        rivals = evidence.best_other(scheme, cell)
        if rivals is None:
            return None
        name, of_scheme, of_other = rivals
        return mean_ratio(f"{cell}: {scheme} / {name}", of_scheme, of_other, 1.0, side)

    return gather(text, [(str(cell), decide(cell)) for cell in cells])


def claim_ratio(
    text: str,
    evidence: Evidence,
    schemes: tuple[str, str],
    cells: Sequence[Cell],
    side: Side,
    *,
    measure: str = "position",
) -> Claim:
    """Compare the ratio of the first scheme's mean error to the second's with 1 in all cells."""
    first, second = schemes

    def decide(cell: Cell) -> Decision | None:
        ratio = (first, cell, measure), (second, cell, measure)
        return evidence.compare(f"{cell}: {first} / {second}", ratio, 1.0, side)

    return gather(text, [(str(cell), decide(cell)) for cell in cells])
