"""The schemes and baselines of the hub study: what each is, how it is drawn, and where its code is.

Entries of the keys `schemes` and `baselines` name them, or schemes of a user.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import NoReturn

from owtsweep.config import Plain
from owtsweep.errors import require
from owtsweep.figures.palette import SchemeStyle
from owtsweep.studies.base.schemes import (
    AnyScheme,
    Entry,
    Listed,
    SchemeTable,
    StoredScheme,
    blame_code,
    list_names,
)
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Scheme

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
