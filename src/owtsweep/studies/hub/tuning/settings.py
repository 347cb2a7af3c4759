"""The keys `tune.*`: what the command `tune` searches, and how it judges the result."""

from __future__ import annotations

from owtsweep.config import Positive, Section, key


class Tune(Section):
    """The settings of the command `tune`. No result of a run depends on them."""

    amplitude: list[Positive] | None = key(
        "smallest and largest amplitude that `tune` tunes for; null: those of the grid",
        unit="m",
        form="two amplitudes in m, smallest first, e.g. tune.amplitude=[0.2,3]",
        default=None,
        min_length=2,
        max_length=2,
    )
    trials: int = key("trials of `tune` per scheme", default=100, ge=1, le=100_000)
    seed: int = key(
        "of the search; not the run's `seed`, with which `tune` judges what it found",
        default=7,
        ge=0,
        advice="use an integer >= 0",
    )
    replicates: int = key(
        "records per natural period on which `tune` judges what it found", default=8, ge=2, le=1000
    )
