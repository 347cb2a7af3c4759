"""The names of the hub study's schemes and baselines, and what each is."""

from __future__ import annotations

from typing import Any

#: Name -> description, in the order of tables and figures. The scheme EKF is `SCHEME` in the module
#: `schemes.ekf`, and so on.
REGISTERED = {
    "EKF": "Kalman filter, GNSS innovation zeroed between fixes",
    "MKF": "multirate Kalman filter on the undelayed IMU",
    "HME1": "delayed MKF, online smoother, predictor",
    "HME2": "HME1 fed by a moving horizon estimator",
}
#: Name -> description of the baselines. They are schemes too, with modules of their own.
BASELINES = {
    "NONE": "no estimator: zero position, zero velocity",
    "HOLD": "the last fix, zero velocity",
    "DELTA": "the last fix, moved on with the velocity of the last two fixes",
}
#: Name -> what to do where no scheme is better than the baseline.
INSTEAD = {
    "NONE": "no estimator needed, motion below the sensors",
    "HOLD": "hold the fix",
    "DELTA": "extend the line of the last two fixes",
}

#: Name -> description of further schemes, which run only if the key `schemes` names them.
ON_REQUEST = {
    "SKF": "Kalman filter that is told the spectrum and the amplitude of the motion",
    "SKFA": "SKF that is told nothing and tracks the sea itself; for fixes without outliers",
    "SWITCH": "HME1 or HME2, by estimated amplitude and period",
}
#: Name -> description of every scheme and baseline.
ALL = {**REGISTERED, **BASELINES, **ON_REQUEST}


def list_entries(config: Any) -> list[Any]:
    """Return the entries of all schemes that a configuration runs: `schemes`, then baselines."""
    return [*config.schemes, *list_baselines(config)]


def list_baselines(config: Any) -> list[str]:
    """Return the names of the baselines of a configuration.

    A baseline that the key `schemes` names too is a scheme like the others, and not listed.
    """
    return [name for name in config.baselines if name not in config.schemes]
