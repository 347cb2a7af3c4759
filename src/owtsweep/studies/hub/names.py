"""The schemes and baselines of the hub study: their names, what each is, and how it is drawn."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.figures.palette import SchemeStyle
from owtsweep.studies.base.schemes import Entry, Listed

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig

#: The paper's schemes. EKF and MKF can coincide: a dashed line over a solid one shows both.
REGISTERED = {
    "EKF": Listed(
        "Kalman filter, GNSS innovation zeroed between fixes", SchemeStyle("#CC79A7", "s", "-")
    ),
    "MKF": Listed(
        "multirate Kalman filter on the undelayed IMU", SchemeStyle("#009E73", "D", (0, (4, 2)))
    ),
    "HME1": Listed("delayed MKF, online smoother, predictor", SchemeStyle("#0072B2", "o", "-")),
    "HME2": Listed(
        "HME1 fed by a moving horizon estimator",
        SchemeStyle("#E69F00", "^", (0, (6, 1, 1, 1))),
    ),
}
#: The baselines: pale, and of one hue that no scheme has.
BASELINES = {
    "NONE": Listed("no estimator: zero position, zero velocity", SchemeStyle("#D3CCE3", "*", "-")),
    "HOLD": Listed("the last fix, zero velocity", SchemeStyle("#B8AED0", "d", (0, (4, 2)))),
    "DELTA": Listed(
        "the last fix, moved on with the velocity of the last two fixes",
        SchemeStyle("#9C8FBD", "8", (0, (1, 2))),
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
    ),
    "SKFA": Listed(
        "SKF that is told nothing and tracks the sea itself; for fixes without outliers",
        SchemeStyle("#B3261E", "h", (0, (4, 2))),
    ),
    "SWITCH": Listed("HME1 or HME2, by estimated amplitude and period", None),
}
#: Every scheme and baseline, in the order of tables and figures.
LISTED = {**REGISTERED, **BASELINES, **ON_REQUEST}


def describe() -> dict[str, str]:
    """Return name -> sentence of each scheme and baseline, which says how it is asked for."""
    kinds = {"": REGISTERED, "on request (schemes=[...]): ": ON_REQUEST}
    kinds["baseline (baselines=[...]): "] = BASELINES
    return {
        name: f"{asked}{listed.sentence}"
        for asked, of_kind in kinds.items()
        for name, listed in of_kind.items()
    }


def list_entries(config: HubConfig) -> list[Entry]:
    """Return the entries of all schemes that a configuration runs: `schemes`, then baselines."""
    return [*config.schemes, *list_baselines(config)]


def list_baselines(config: HubConfig) -> list[str]:
    """Return the names of the baselines of a configuration.

    A baseline that the key `schemes` names too is a scheme like the others, and not listed.
    """
    return [name for name in config.baselines if name not in config.schemes]
