"""Schemes whose gains depend on the measurements: they are not linear and have no kernel."""

from __future__ import annotations

from numpy.typing import ArrayLike

from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.known import ZERO, Estimator, Known


class Stepwise(Scheme):
    """A scheme of the package under a tuning that makes its gains depend on the measurements.

    `unbatched` says what makes it so.
    """

    def __init__(self, scheme: Scheme, unbatched: str) -> None:
        self.name, self.sections, self.unbatched = scheme.name, scheme.sections, unbatched
        self.on_board = scheme.on_board
        self._scheme = scheme

    def start(self, known: Known) -> Estimator:
        """Return a new estimator that runs step by step."""
        return self._scheme.start(known)

    def stream(self, known: Known, origin: ArrayLike | None = ZERO) -> Estimator:
        """Return a new compiled estimator that runs step by step; `origin` as in `online_chain`.

        With constraints, each window of the moving horizon estimator is solved without them first.
        If this solution breaks a constraint, the window is solved again, with constraints, by
        CasADi.
        """
        return self._scheme.stream(known, origin)
