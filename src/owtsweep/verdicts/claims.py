"""Claims that many studies make: the errors of one scheme compared with those of another."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Protocol, TypeVar

from owtsweep.arrays import Array
from owtsweep.verdicts.inference import Claim, Decision, Side, mean_ratio

#: A cell of the study's grid, by its conditions; `str(cell)` names it.
Cell = TypeVar("Cell", contravariant=True)


class PairedErrors(Protocol[Cell]):
    """The errors of a run, looked up by scheme and cell."""

    def paired(
        self, schemes: Sequence[str], cell: Cell, measure: str = ...
    ) -> dict[str, Array] | None:
        """Scheme -> (replicates,) over the replicates that all finished; None if there are none."""
        ...

    def best_other(self, scheme: str, cell: Cell) -> tuple[str, Array, Array] | None:
        """The best other scheme's name, and (replicates,) of `scheme` and of the other."""
        ...


def gather(text: str, parts: Iterable[tuple[str, Sequence[Decision] | None]]) -> Claim:
    """Combine decisions in many places into one claim.

    Parameters
    ----------
    text
        What is asserted, in words.
    parts
        Name of a place, and the run's decisions there; None where it lacks the data.
    """
    decisions: list[Decision] = []
    missing: list[str] = []
    for name, decided in parts:
        if decided is None:
            missing.append(name)
        else:
            decisions += decided
    return Claim(text, tuple(decisions), tuple(missing))


def claim_against_best(
    text: str, errors: PairedErrors[Cell], scheme: str, cells: Sequence[Cell], side: Side
) -> Claim:
    """Compare the ratio of a scheme's mean error to the best other scheme's with 1 in all cells."""

    def decide(cell: Cell) -> list[Decision] | None:
        rivals = errors.best_other(scheme, cell)
        if rivals is None:
            return None
        name, of_scheme, of_other = rivals
        return [mean_ratio(f"{cell}: {scheme} / {name}", of_scheme, of_other, 1.0, side)]

    return gather(text, [(str(cell), decide(cell)) for cell in cells])


def claim_ratio(
    text: str,
    errors: PairedErrors[Cell],
    schemes: tuple[str, str],
    cells: Sequence[Cell],
    side: Side,
    *,
    measure: str = "position",
) -> Claim:
    """Compare the ratio of the first scheme's mean error to the second's with 1 in all cells."""
    first, second = schemes

    def decide(cell: Cell) -> list[Decision] | None:
        values = errors.paired(schemes, cell, measure)
        if values is None:
            return None
        label = f"{cell}: {first} / {second}"
        return [mean_ratio(label, values[first], values[second], 1.0, side)]

    return gather(text, [(str(cell), decide(cell)) for cell in cells])
