"""The base of the schemes that are chains, and the cache that lets all records share a chain."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Callable
from operator import attrgetter
from typing import Literal

from numpy.typing import ArrayLike

from owtsweep.io.cache import Kept
from owtsweep.studies.hub.chain import LONGEST_TRANSIENT, Chain, Parts, chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import ZERO, Known, Scheme, run_stepwise
from owtsweep.studies.hub.online.estimator import OnlineEstimator
from owtsweep.studies.hub.scheme_sections import FilterTuning

#: The chains in memory: of four schemes under each of two tunings, and of three baselines. A chain
#: whose gains settle slowly takes up to 100 MB.
CHAINS: Kept[Chain] = Kept(11)


class ChainScheme(Scheme):
    """A linear scheme that the batch engine runs as a chain, beside other chains.

    A chain is made once for given sensors, tuning and length of the records. The attribute
    `sections` names the sections of the configuration on which the chain depends.
    """

    linear = True
    batched: Literal["", "chain", "own"] = "chain"

    @abstractmethod
    def make_chain(self, known: Known, steps: int) -> Chain:
        """Make the chain for records of `steps` IMU steps."""

    def kernel(self, known: Known, steps: int | None = None) -> Chain:
        return self._share(known, LONGEST_TRANSIENT if steps is None else steps, self.make_chain)

    def kernel_for_runs(self, known: Known, steps: int) -> Chain:
        return self._share(known, steps, self._make_for_runs)

    def _make_for_runs(self, known: Known, steps: int) -> Chain:
        return self.make_chain(known, steps).for_runs()

    def _share(self, known: Known, steps: int, make: Callable[[Known, int], Chain]) -> Chain:
        sections = tuple(repr(attrgetter(section)(known.tuning)) for section in self.sections)
        key = (type(self), self.name, known.sensors, steps, make.__name__, *sections)
        return CHAINS.find(key, lambda: make(known, steps))


class FilterScheme(ChainScheme):
    """A chain that begins with a Kalman filter, which the first of its `sections` tunes."""

    on_board = True

    def choose_filter(self, config: HubConfig) -> FilterTuning:
        chosen: FilterTuning = getattr(config, self.sections[0])
        return chosen

    @abstractmethod
    def find_parts(self, known: Known) -> Parts:
        """Return the parts of the scheme for sensors and a tuning."""

    def stream(self, known: Known, origin: ArrayLike | None = ZERO) -> OnlineEstimator:
        solver = known.tuning.hme.mhe.solver
        return OnlineEstimator(self.find_parts(known), known.sensors, solver, origin)

    def make_chain(self, known: Known, steps: int) -> Chain:
        return chain(self.find_parts(known), known.sensors, steps)

    def find_gains(self, known: Known) -> Chain:
        """Return the chain for records of any length, for its gains and covariances alone."""
        return self._share(known, LONGEST_TRANSIENT, self._make_without_maps)

    def _make_without_maps(self, known: Known, steps: int) -> Chain:
        return chain(self.find_parts(known), known.sensors, steps, maps=False)

    def under(self, config: HubConfig) -> Scheme:
        """Return `self`, to be run step by step if fixes lose weight."""
        plain = self.choose_filter(config).fix_rule == "plain"
        return self if plain else run_stepwise(self, "its fix_rule leaves")
