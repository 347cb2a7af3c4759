"""Claims about the scores of the paper's case studies: at every place, the mean over records."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from experiments.simpson2025.evidence import Scores
from experiments.simpson2025.scenarios import SETUPS, Scenario
from owtsweep.arrays import Array
from owtsweep.studies.tower.contract import DIRECTIONS
from owtsweep.verdicts.inference import Claim, Side
from owtsweep.verdicts.means import claim_means


class Place(NamedTuple):
    """Where a score is looked up: a scenario, a direction, a quantity."""

    scenario: Scenario
    direction: str
    quantity: str

    def __str__(self) -> str:
        """Return the place in words, e.g. "Sparse: θ-a, M0 fa"."""
        setup = SETUPS.get(self.scenario.sensors, self.scenario.sensors)
        return f"{setup}, {self.quantity} {self.direction}"


def everywhere(
    scenarios: Iterable[Scenario],
    quantities: Iterable[str],
    directions: Iterable[str] = DIRECTIONS,
) -> list[Place]:
    """Return all places of scenarios, directions and quantities."""
    kept, each = list(quantities), list(directions)
    return [Place(s, d, q) for s in scenarios for d in each for q in kept]


def claim(
    text: str,
    scores: Scores,
    places: Iterable[Place],
    measure: str,
    side: Side,
    threshold: float,
    *,
    of: Callable[[Array], Array] = np.abs,
) -> Claim:
    """Claim that the mean of a measure lies below (above) a threshold at all places.

    `of` turns values (records,) into what is compared, e.g. the distance from 1.
    """
    parts: list[tuple[str, Array | None]] = []
    for place in places:
        values = scores.find(*place, measure)
        parts.append((str(place), None if values is None else of(values)))
    return claim_means(text, parts, side, threshold)


def claim_ratio(
    text: str,
    scores: Scores,
    pairs: Iterable[tuple[Place, Place]],
    measures: tuple[str, str],
    side: Side,
    threshold: float,
) -> Claim:
    """Claim that ratios of two scores lie below (above) a threshold; signs do not count.

    The ratio is taken in each record, and its mean over the records is judged. Of errors that
    scatter by orders of magnitude between records, the larger one belongs below the line.
    """
    parts: list[tuple[str, Array | None]] = []
    for above, below in pairs:
        first, second = scores.find(*above, measures[0]), scores.find(*below, measures[1])
        label = str(above) if above == below else f"{above} / {below}"
        ratio = None if first is None or second is None else np.abs(first / second)
        parts.append((label, ratio))
    return claim_means(text, parts, side, threshold)


def claim_difference(
    text: str,
    scores: Scores,
    pairs: Iterable[tuple[Place, Place]],
    measure: str,
    limit: float,
) -> Claim:
    """Claim that a measure at two places differs by less than a limit, in the mean over records."""
    parts: list[tuple[str, Array | None]] = []
    for first, second in pairs:
        one, other = scores.find(*first, measure), scores.find(*second, measure)
        label = f"{first} / {second}"
        difference = None if one is None or other is None else np.abs(one - other)
        parts.append((label, difference))
    return claim_means(text, parts, "below", limit)


def below_one(values: Array) -> Array:
    """Return 1 - values, not below 0."""
    return np.asarray(np.maximum(1.0 - values, 0.0))


def invert(values: Array) -> Array:
    """Return 1 / values."""
    return np.asarray(1.0 / values)


def off_one(values: Array) -> Array:
    """Return by how much values differ from 1."""
    return np.asarray(np.abs(values - 1.0))
