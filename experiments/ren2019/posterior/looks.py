"""Looks at readings: which are tried, and how each is followed until its scatter is its own.

How one record scatters depends on the settings, and what settings the print leaves depends on the
scatter. So a look samples with the scatter of the draws before it, until the evidence stays. Half
of them are of the look before that one: with the last alone, readings of shared seeds swung
between two scatters, by up to 17 in the evidence, and never settled.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import NamedTuple

import numpy as np
from joblib import Parallel, delayed

from experiments.ren2019.posterior.evidence import Posterior, load_posterior
from experiments.ren2019.posterior.inference import (
    Draws,
    Inference,
    first_of,
    load_records,
    name_settings,
)
from experiments.ren2019.posterior.likelihood import Likelihood
from experiments.ren2019.posterior.records import DRAWS
from experiments.ren2019.posterior.settings import ACCURACIES, FORCES, LENGTHS, MOTIONS, Reading

#: Where tables, records and posteriors are kept; they can be made again.
KEPT = Path("results/posterior")
#: Seeds of the sampling.
SEEDS = (1, 2)
#: Live points of a first look, of each look, and of the closest.
FIRST, LIVE, CLOSELY = 50, 80, 250
#: Readings whose evidence is this far below at the first look are not looked at again; those that
#: are this far below then are followed, also with shared seeds.
NEAR, CLOSE = 25.0, 8.0
#: A reading is followed until a turn moves its evidence by less than this, which is two standard
#: errors of the evidence with `LIVE` points, but for so many turns at most.
SETTLED, TURNS = 1.5, 9
#: How many of the closest readings are sampled closely.
CLOSEST = 6


class Look(NamedTuple):
    """A reading's likelihood and what was sampled from it.

    turns: how often the scatter was computed anew. moved: what the last turn added to the evidence.
    before: what the look before this one sampled.
    """

    likelihood: Likelihood
    posterior: Posterior
    turns: int = 0
    moved: float = np.nan
    before: Posterior | None = None

    @property
    def reading(self) -> Reading:
        return self.likelihood.reading

    @property
    def draws(self) -> Draws:
        """Draws of the settings, from which the next scatter comes, `DRAWS` of equal weight."""
        sampled = [look for look in (self.before, self.posterior) if look is not None]
        count = DRAWS // len(sampled)  # draws are independent, so the first ones do
        return [name_settings(point) for look in sampled for point in look.points[:count]]


def list_readings() -> list[Reading]:
    """Return combinations of accuracy, length and force, and of what is tried for some alone.

    A level IMU without its start at all lengths; other spectra at 400 s.
    """
    whole = [Reading(a, n, True, f) for a, n, f in product(ACCURACIES, LENGTHS, FORCES)]
    settled = [Reading(a, n, start=False) for a, n in product(ACCURACIES, LENGTHS)]
    moved = [
        Reading(accuracy, 400.0, True, force, spectrum)
        for accuracy in ACCURACIES
        for force, spectrum in MOTIONS
        if spectrum != "middle"
    ]
    return [*whole, *settled, *moved]


def load_all(cases: Sequence[tuple[Reading, Draws]], first: int = 0) -> None:
    """Simulate the records of readings and draws side by side, so that they are kept."""
    different = {str((replace(of, seeds="own"), draws)): (of, draws) for of, draws in cases}
    jobs = (delayed(load_records)(KEPT, of, draws, first) for of, draws in different.values())
    Parallel(2, backend="multiprocessing")(jobs)


def sample_all(
    likelihoods: Sequence[Likelihood], seed: int = SEEDS[0], live: int = LIVE
) -> list[Posterior]:
    """Sample side by side; posteriors are kept, so that a run that was stopped goes on."""
    jobs = (delayed(load_posterior)(KEPT, each, seed, live) for each in likelihoods)
    return list(Parallel(2)(jobs))


def take_own(inference: Inference, looks: Sequence[Look], first: int = 0) -> list[Likelihood]:
    """Return the likelihoods of readings with the scatter of their own draws."""
    cases = [(look.reading, look.draws) for look in looks]
    load_all(cases, first)
    return [inference.likelihood(reading, draws, first) for reading, draws in cases]


def look_first(inference: Inference) -> list[Look]:
    """Look at all readings, with the scatter of what was searched."""
    readings = list_readings()
    load_all([first_of(reading) for reading in readings])
    likelihoods = [inference.likelihood(reading) for reading in readings]
    return list(map(Look, likelihoods, sample_all(likelihoods, live=FIRST)))


def take_turn(inference: Inference, looks: Sequence[Look], live: int = LIVE) -> list[Look]:
    """Look again with the scatter of the draws of `looks`."""
    likelihoods = take_own(inference, looks)
    found = sample_all(likelihoods, live=live)
    return [
        Look(each, now, last.turns + 1, now.evidence - last.posterior.evidence, last.posterior)
        for each, now, last in zip(likelihoods, found, looks, strict=True)
    ]


def follow(inference: Inference, looks: Sequence[Look]) -> list[Look]:
    """Take turns with each reading until it is settled, or has had all its turns."""
    found = list(looks)
    while moving := [n for n, look in enumerate(found) if not is_settled(look)]:
        turned = take_turn(inference, [found[number] for number in moving])
        for number, look in zip(moving, turned, strict=True):
            found[number] = look
    return found


def is_settled(look: Look) -> bool:
    return look.turns >= TURNS or abs(look.moved) < SETTLED


def look_again(inference: Inference, looks: Sequence[Look]) -> list[Look]:
    """Take one turn with near readings, and follow close ones, with both kinds of seeds."""
    near = take_turn(inference, choose_near(looks, NEAR))
    close = choose_near(near, CLOSE)
    far = leave_out(close, near)
    shared = [share_seeds(look) for look in close]
    return [*far, *follow(inference, [*close, *shared])]


def share_seeds(look: Look) -> Look:
    """Return where a reading's twin with shared seeds starts: at the draws of the own ones."""
    reading = replace(look.reading, seeds="shared")
    # the evidence is another reading's, so that the first turn cannot settle the twin
    return Look(replace(look.likelihood, reading=reading), look.posterior._replace(evidence=np.nan))


def choose_near(looks: Sequence[Look], near: float) -> list[Look]:
    """Return the looks whose evidence is less than `near` below the greatest."""
    least = max(look.posterior.evidence for look in looks) - near
    return [look for look in looks if look.posterior.evidence > least]


def choose_closest(looks: Sequence[Look]) -> list[Look]:
    """Return the closest readings, and the closest with a level IMU of each kind of seeds."""
    order = sorted(looks, key=lambda look: -look.posterior.evidence)
    level: dict[str, Look] = {}
    for look in order:
        if look.reading.force == "level":
            level.setdefault(look.reading.seeds, look)
    first = order[:CLOSEST]
    return [*first, *leave_out(first, level.values())]


def leave_out(some: Sequence[Look], looks: Iterable[Look]) -> list[Look]:
    return [look for look in looks if all(look is not each for each in some)]
