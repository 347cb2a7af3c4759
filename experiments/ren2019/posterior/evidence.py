"""Sample the posterior of the settings under a reading, and compute the reading's evidence."""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np

from experiments.ren2019.posterior.likelihood import Likelihood
from experiments.ren2019.posterior.tables import keep
from owtsweep.arrays import Array

#: The part of the logarithm of the evidence that nested sampling may leave.
LEFT = 0.3


class Posterior(NamedTuple):
    """What nested sampling found.

    evidence, error: logarithm of the evidence, and its standard deviation.
    points: draws of equal weight, shape (draws, dimensions), places in the unit cube.
    likelihoods: logarithm of the likelihood of each draw, shape (draws,).
    """

    evidence: float
    error: float
    points: Array
    likelihoods: Array

    @property
    def best(self) -> Array:
        """The draw of the greatest likelihood, shape (dimensions,). Priors are flat in the cube.

        Not the maximum itself: where a scheme's discrepancy may be large, that can lie in a corner.
        """
        return np.asarray(self.points[int(np.argmax(self.likelihoods))])


def sample(likelihood: Likelihood, seed: int, live: int) -> Posterior:
    """Sample by nested sampling (Skilling 2006; Speagle 2020, MNRAS 493, 3132: dynesty).

    live: number of live points; the evidence's error falls with its root.
    """
    from dynesty import NestedSampler

    generator = np.random.default_rng(seed)
    sampler = NestedSampler(
        likelihood,
        lambda unit: unit,
        likelihood.dimensions,
        nlive=live,
        bound="single",
        sample="rwalk",
        rstate=generator,
    )
    sampler.run_nested(dlogz=LEFT, print_progress=False)
    found = sampler.results
    weights = found.importance_weights()
    chosen = generator.choice(len(weights), 2000, p=weights / weights.sum())
    return Posterior(
        float(found.logz[-1]),
        float(found.logzerr[-1]),
        np.asarray(found.samples[chosen]),
        np.asarray(found.logl[chosen]),
    )


def load_posterior(folder: Path, likelihood: Likelihood, seed: int, live: int) -> Posterior:
    """Return what `sample` finds, kept in a folder."""

    def make() -> dict[str, Array]:
        return {
            name: np.asarray(value)
            for name, value in sample(likelihood, seed, live)._asdict().items()
        }

    some = np.linspace(0.1, 0.9, likelihood.dimensions)  # what the likelihood is, by its values
    values = [likelihood(np.roll(some, shift)) for shift in range(3)]
    said = (likelihood.reading, values, likelihood.part, likelihood.discrepant, seed, live, LEFT)
    found = keep(folder, "posterior", said, make)
    return Posterior(
        float(found["evidence"]), float(found["error"]), found["points"], found["likelihoods"]
    )
