"""Make claims that one scheme's errors are smaller (or larger) than those of another scheme."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence

from owtsweep.verdicts.evidence import Cell, Evidence
from owtsweep.verdicts.inference import Claim, Decision, Estimate, Side, mean_ratio


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


def claim_estimate(
    text: str, name: str, estimate: Estimate | None, thresholds: Mapping[Side, float]
) -> Claim:
    """Make a claim that compares an estimate with a threshold, or with one threshold on each side.

    Parameters
    ----------
    text
        What is claimed, in words.
    name
        Name of the estimate. If the estimate is None, the claim has no decision, and this name is
        its missing datum.
    estimate
        A quantity with its 95 % interval; None if the run lacks the quantity.
    thresholds
        Side ("below" or "above") -> the threshold on whose side the quantity is claimed to lie.
    """
    if estimate is None:
        return Claim(text, (), (name,))
    return Claim(text, tuple(estimate.against(limit, side) for side, limit in thresholds.items()))


def claim_against_best(
    text: str, evidence: Evidence, scheme: str, cells: Sequence[Cell], side: Side
) -> Claim:
    """Claim for every cell that a scheme's error is smaller (or larger) than its best rival's.

    A cell is a combination of conditions in the run's grid. In each cell the ratio of the two means
    of the evidence's criterion is compared with 1. The best rival is found in each cell by
    `Evidence.best_other`. The claim's `missing` lists cells without data.

    Parameters
    ----------
    text
        What is claimed, in words.
    evidence
        The run's values.
    scheme
        The scheme in the numerator of the ratio.
    cells
        The cells to compare.
    side
        "below" to claim that the numerator is smaller, "above" to claim that it is larger.
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
    measure: str = "",
) -> Claim:
    """Claim for every cell that one scheme's error is smaller (or larger) than a second scheme's.

    A cell is a combination of conditions in the run's grid. In each cell the ratio of the two mean
    errors is compared with 1. The claim's `missing` lists cells without data.

    Parameters
    ----------
    text
        What is claimed, in words.
    evidence
        The run's values.
    schemes
        The schemes in the numerator and in the denominator of the ratio.
    cells
        The cells to compare.
    side
        "below" to claim that the numerator is smaller, "above" to claim that it is larger.
    measure
        The kind of error, e.g. "velocity" for the velocity MSE; "" for the evidence's criterion.
    """
    first, second = schemes

    def decide(cell: Cell) -> Decision | None:
        kind = measure or evidence.criterion
        ratio = (first, cell, kind), (second, cell, kind)
        return evidence.compare(f"{cell}: {first} / {second}", ratio, 1.0, side)

    return gather(text, [(str(cell), decide(cell)) for cell in cells])
