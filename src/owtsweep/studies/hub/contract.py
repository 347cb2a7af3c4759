"""The contract between the hub study and a scheme, be it the package's own or a user's."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Literal, NoReturn, Protocol

import numpy as np
from numpy.typing import ArrayLike

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.evaluation.estimate import Estimate
from owtsweep.evaluation.loop import run_estimator
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.base import contract
from owtsweep.studies.base.contract import ByFunction, Knowledge
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.sensors import Measured, Sensors

if TYPE_CHECKING:
    from owtsweep.studies.hub.chain import Chain
    from owtsweep.studies.hub.measures import Sums
    from owtsweep.studies.hub.records import Records

__all__ = ["Estimator", "Known", "Measured", "Scheme"]


class OwnKernel(Protocol):
    """A scheme in a form for the batch engine that is no `Chain`: it runs itself."""

    def sum_errors(
        self, records: Records, settled: int, amplitude: float, *, keep_squared: bool = False
    ) -> Sums:
        """Run motion plus noise at an amplitude (m) on all replicates of some records.

        The sums are those of `batch.sum_errors` with an amplitude. `settled` is the number of the
        first step after the settling time.
        """


#: Where the coordinates of the studies begin. An origin of None stands for the first fix.
ZERO = (0.0, 0.0)


@dataclass(frozen=True, eq=False)
class Known(Knowledge):
    """All that a scheme may know beforehand of a case.

    tuning: the configuration of one tuning; its sections ekf, mkf, hme1, hme2, hme, ... hold the
        numbers of the schemes.
    natural_period, amplitude: of the motion, s and m, for schemes with `Scheme.knows_motion`; else
        None.
    """

    sensors: Sensors
    tuning: HubConfig
    natural_period: float | None = None
    amplitude: float | None = None


class Estimator(Protocol):
    """The interface of a running estimator, whose method `update` is called once per IMU step."""

    def update(self, specific_force: Array, position: Array | None = None) -> Estimate:
        """Take an IMU sample, and a position fix or None; return the estimate of the present.

        specific_force: in the IMU's frame, m/s^2, shape (2,).
        position: the fix in NED, m, shape (2,): the position of `Sensors.delay` steps ago. None at
            steps without a fix.
        Returns: position (m) and velocity (m/s) in NED, shape (2,) each; perhaps a covariance
            (4, 4) of x, y, v_x, v_y, and the innovation of the fix, shape (2,), m.
        """


class Scheme(contract.Scheme[Known, Measured, Trajectory]):
    """An estimation scheme of the hub study: it gives an estimator, which runs step by step.

    linear: whether estimates are linear in the measurements, with gains that do not depend on them.
        If so, one run with the motion alone and one with the noise alone serve every amplitude.
    knows_motion: whether the scheme must know period and amplitude of the motion. It is run at each
        amplitude.
    batched: how the engine `batch` runs records of the scheme: "chain", beside other chains, in the
        form that `kernel` gives; "own", by the kernel that `own_kernel` gives; "" step by step.
    on_board: whether `stream` gives an estimator for use on board, which knows an origin.
    unbatched: why a scheme that can run as a chain does not under the tuning, as subject of a
        message with its verb, e.g. "its constraints leave"; "" if that is not so.
    expected_in_cell: whether the engine `expected` knows the settled error of the scheme in a cell,
        and nothing else; the errors of other linear schemes follow from their chains.
    least_duration: the shortest record, s, in which the scheme chooses a spectrum; 0 if it chooses
        none.
    """

    study = "hub"
    linear: bool = False
    sections: Sequence[str] = ("ekf", "mkf", "hme1", "hme2", "hme")
    batched: Literal["", "chain", "own"] = ""
    on_board: bool = False
    unbatched: str = ""
    expected_in_cell: bool = False
    least_duration: float = 0.0

    @abstractmethod
    def start(self, known: Known) -> Estimator:
        """Return a new estimator whose estimate is zero."""

    def prepare(self, known: Known) -> ByFunction[Known, Measured, Trajectory]:
        """Return the scheme ready for records; it is started again for each."""
        return ByFunction(partial(_run_by_steps, self), known)

    def stream(self, known: Known, origin: ArrayLike | None = ZERO) -> Estimator:
        """Return a new estimator for use on board, compiled if there is one.

        `origin` is the point about which it starts from zero, m, shape (2,); None stands for the
        first fix. Only a scheme that is `on_board` knows another origin than zero.
        """
        return self.start(known)

    def start_for_runs(self, known: Known) -> Estimator:
        """Return a new estimator for records: with engine=batch compiled, if there is one."""
        return self.stream(known) if known.tuning.engine == "batch" else self.start(known)

    def tell(self, known: Known) -> Known:
        """Return what the scheme may use of what is known: the motion only if it must know it."""
        return known if self.knows_motion else replace(known, natural_period=None, amplitude=None)

    def kernel(self, known: Known, steps: int | None = None) -> Chain:
        """Return the scheme as a chain for records of `steps` IMU steps; None: of any length.

        Only a scheme whose `batched` is "chain" has one.
        """
        self._lacks("kernel")

    def kernel_for_runs(self, known: Known, steps: int) -> Chain:
        """Return the scheme as a chain that may lack what a run does not need."""
        return self.kernel(known, steps)

    def own_kernel(self, known: Known, steps: int) -> OwnKernel:
        """Return the scheme's own kernel for records of `steps` IMU steps.

        Only a scheme whose `batched` is "own" has one.
        """
        self._lacks("own_kernel")

    def under(self, config: HubConfig) -> Scheme:
        """Return the variant of the scheme for which the configuration of one tuning asks."""
        return self

    def check(self, config: HubConfig) -> None:
        """Refuse by InputError, or warn of, settings with which the scheme cannot work."""

    def check_declared(self) -> None:
        """Raise InputError if a user's class states an attribute of a wrong type."""
        super().check_declared()
        require(isinstance(self.linear, bool), "it lacks linear (True or False)")
        require(
            self.batched in ("", "chain", "own"),
            f'batched = {self.batched!r} is none of "", "chain", "own"',
        )
        method = {"": "start", "chain": "kernel", "own": "own_kernel"}[self.batched]
        require(
            getattr(type(self), method) is not getattr(Scheme, method),
            f"batched = {self.batched!r}, but it lacks the method {method}",
        )

    def _lacks(self, method: str) -> NoReturn:
        raise NotImplementedError(f"{self.name} has no {method}")


def _run_by_steps(scheme: Scheme, known: Known, measured: Measured) -> Trajectory:
    estimator = scheme.start_for_runs(known)
    with np.errstate(over="ignore", invalid="ignore"):  # reported as the reason of a failure
        return run_estimator(estimator, *measured, known.sensors.fix_interval)


def run_stepwise(scheme: Scheme, unbatched: str) -> Scheme:
    """Return a scheme of the package for gains that depend on the measurements: it has no kernel.

    `unbatched` says why. With constraints, each window of the MHE is solved without them first. If
    this solution breaks a constraint, the window is solved again, with constraints, by CasADi.
    """
    stepwise = copy(scheme)
    stepwise.linear, stepwise.batched, stepwise.unbatched = False, "", unbatched
    return stepwise
