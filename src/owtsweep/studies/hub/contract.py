"""The schemes of the hub study: their contract, and what each scheme and baseline is.

The contract holds for the package's own schemes and for a user's. Entries of the keys `schemes` and
`baselines` name schemes that are listed here, or schemes of a user.
"""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Mapping, Sequence
from copy import copy
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING, Literal, NoReturn, Protocol

import numpy as np
from numpy.typing import ArrayLike

from owtsweep.arrays import Array
from owtsweep.config import Plain
from owtsweep.errors import require
from owtsweep.evaluation.estimate import Estimate
from owtsweep.evaluation.loop import run_estimator
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.figures.palette import SchemeStyle
from owtsweep.studies.base import schemes
from owtsweep.studies.base.schemes import (
    AnyScheme,
    ByFunction,
    Entry,
    Knowledge,
    Listed,
    SchemeTable,
    StoredScheme,
    blame_code,
    list_names,
)
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


class Scheme(schemes.Scheme[Known, Measured, Trajectory]):
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


#: The paper's schemes. EKF and MKF can coincide: a dashed line over a solid one shows both.
REGISTERED = {
    "EKF": Listed(
        "Kalman filter, GNSS innovation zeroed between fixes",
        SchemeStyle("#CC79A7", "s", "-"),
        simplicity=18,  # as MKF, a tie: MKF updates as the textbook does
    ),
    "MKF": Listed(
        "multirate Kalman filter on the undelayed IMU",
        SchemeStyle("#009E73", "D", (0, (4, 2))),
        simplicity=17,  # 8 states; q_a, q_b, tilt, R of fix and IMU, 4 initial variances
    ),
    "HME1": Listed(
        "delayed MKF, online smoother, predictor",
        SchemeStyle("#0072B2", "o", "-"),
        simplicity=19,  # MKF; lengths of register 1 and of the smoother's window
    ),
    "HME2": Listed(
        "HME1 fed by a moving horizon estimator",
        SchemeStyle("#E69F00", "^", (0, (6, 1, 1, 1))),
        simplicity=33,  # HME1; of the MHE 6 states of its first node, and 8 keys
    ),
}
#: The baselines: pale, and of one hue that no scheme has.
BASELINES = {
    "NONE": Listed(
        "no estimator: zero position, zero velocity",
        SchemeStyle("#D3CCE3", "*", "-"),
        simplicity=0,  # nothing
    ),
    "HOLD": Listed(
        "the last fix, zero velocity",
        SchemeStyle("#B8AED0", "d", (0, (4, 2))),
        simplicity=2,  # the last fix
    ),
    "DELTA": Listed(
        "the last fix, moved on with the velocity of the last two fixes",
        SchemeStyle("#9C8FBD", "8", (0, (1, 2))),
        simplicity=4,  # the last two fixes
    ),
}
#: Name -> what to do where no scheme is better than the baseline.
INSTEAD = {
    "NONE": "no estimator needed, motion below the sensors",
    "HOLD": "hold the fix",
    "DELTA": "extend the line of the last two fixes",
}
#: Further schemes, which run only if the key `schemes` names them.
ON_REQUEST = {
    "SKF": Listed(
        "Kalman filter that is told the spectrum and the amplitude of the motion",
        SchemeStyle("#4D4D4D", "p", "-"),
        simplicity=42,  # 16 states and bias for each axis; 8 keys and variances
    ),
    "SKFA": Listed(
        "Kalman filter that learns the sea from its measurements, and refuses outlying fixes",
        SchemeStyle("#B3261E", "h", (0, (4, 2))),
        simplicity=44,  # 8 states, bias and chosen spectrum (3) for each axis; 20 of its rules
    ),
    "SWITCH": Listed(
        "HME1 or HME2, by estimated amplitude and period",
        None,
        simplicity=67,  # HME1 and HME2; 11 states of watch and choice; 4 keys
    ),
}
#: Every scheme and baseline, in the order of tables and figures.
LISTED = {**REGISTERED, **BASELINES, **ON_REQUEST}


def describe() -> dict[str, str]:
    """Return name -> sentence of each scheme and baseline, which says how to choose it."""
    kinds = {"": REGISTERED, "on request (schemes=[...]): ": ON_REQUEST}
    kinds["baseline (baselines=[...]): "] = BASELINES
    return {
        name: f"{how}{listed.sentence}"
        for how, of_kind in kinds.items()
        for name, listed in of_kind.items()
    }


def list_baselines(config: HubConfig) -> list[str]:
    """Return the names of the baselines that the key `schemes` does not name too."""
    return [name for name in config.baselines if name not in config.schemes]


class StoredHubScheme(StoredScheme, Scheme):
    """The stand-in for a user's scheme of the hub in a stored run."""

    kept = ("name", "simplicity", "linear", "batched")

    def __init__(self, entry: Mapping[str, object], described: Plain) -> None:
        super().__init__(entry, described)
        self.linear, self.batched = described["linear"], described["batched"]
        self.check_declared()

    def start(self, *_: object, **__: object) -> NoReturn:
        self.refuse()

    kernel = own_kernel = start


class HubTable(SchemeTable):
    """The hub's schemes and baselines; a scheme may have variants, for which a tuning asks."""

    def list_entries(self, config: HubConfig) -> list[Entry]:
        return [*config.schemes, *list_baselines(config)]

    def choose(self, config: HubConfig) -> list[AnyScheme]:
        return [*resolve_all(self.list_entries(config), config)]

    def describe_one(self, name: str) -> dict[str, str]:
        """Return facts on a scheme in words, with what it can do."""
        facts = super().describe_one(name)
        if name in self.listed:
            scheme = resolve(name)
            able = {
                "linear": scheme.linear,
                "runs by compiled kernels": scheme.batched != "",
                "runs on board": scheme.on_board,
            }
            facts["can"] = ", ".join(what for what, can in able.items() if can)
        return facts


#: The modules with several schemes, and the schemes and baselines of the study.
SHARED = {"mkf": ("EKF",), "baselines": tuple(BASELINES)}
SCHEMES = HubTable("hub", "owtsweep.studies.hub.schemes", LISTED, SHARED, StoredHubScheme)


def resolve(entry: Entry) -> Scheme:
    """Return the scheme for which an entry stands; raises as `SchemeTable.resolve`."""
    scheme = SCHEMES.resolve(entry)
    assert isinstance(scheme, Scheme)
    return scheme


def resolve_all(entries: Sequence[Entry], config: HubConfig | None = None) -> list[Scheme]:
    """Return the schemes of entries in order, or the variants for which `config` asks.

    Raises InputError as `SchemeTable.resolve_all`, or if a scheme has no variant.
    """
    schemes = [scheme for scheme in SCHEMES.resolve_all(entries) if isinstance(scheme, Scheme)]
    return schemes if config is None else [under(scheme, config) for scheme in schemes]


def scheme_names(config: HubConfig) -> list[str]:
    """Return the names of a configuration's schemes, without baselines, as in its key `schemes`."""
    return list_names(config.schemes)


def under(scheme: Scheme, config: HubConfig) -> Scheme:
    """Return the variant of a scheme for which the configuration of one tuning asks.

    Raises InputError if the scheme's method `under` fails or returns no scheme.
    """
    with blame_code(scheme.name, "its method `under` must return a scheme"):
        variant = scheme.under(config)
        require(isinstance(variant, Scheme), f"`under` gives a {type(variant).__name__}")
        variant.check_declared()
    return variant
