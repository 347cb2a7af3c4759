"""Claims that papers often make: one scheme's errors are smaller or larger than another's."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from owtsweep.verdicts.evidence import Cell, Evidence
from owtsweep.verdicts.inference import Claim, Decision, Estimate, Side, mean_ratio


def gather(text: str, parts: Iterable[tuple[str, Decision | None]]) -> Claim:
    """Combine the decisions on many places, e.g. cells of a grid, into one claim.

    Parameters
    ----------
    text
        What is asserted, in words.
    parts
        Name of a place, and the run's decision there; None where the run lacks the data. A place
        may occur several times. The names of places without a decision become the claim's
        `missing`, each once.
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
    """Make a claim that compares an estimate with one threshold on each side given.

    Without an estimate, the claim has no decision, and `name` is its missing datum.
    """
    if estimate is None:
        return Claim(text, (), (name,))
    return Claim(text, tuple(estimate.against(limit, side) for side, limit in thresholds.items()))


def claim_against_best(
    text: str, evidence: Evidence, scheme: str, cells: Sequence[Cell], side: Side
) -> Claim:
    """Claim for every cell that a scheme's mean error is below (above) the best other scheme's.

    The ratio of the two mean position MSEs is compared with 1. The best other scheme is chosen in
    each cell by `Evidence.best_other`. A cell without the data is missing.
    """

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
    """Claim for every cell that the first scheme's mean error is below (above) the second's.

    The ratio of the two means of `measure` is compared with 1. A cell without the data is missing.
    """
    first, second = schemes

    def decide(cell: Cell) -> Decision | None:
        ratio = (first, cell, measure), (second, cell, measure)
        return evidence.compare(f"{cell}: {first} / {second}", ratio, 1.0, side)

    return gather(text, [(str(cell), decide(cell)) for cell in cells])
