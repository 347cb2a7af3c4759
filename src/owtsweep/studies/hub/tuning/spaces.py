"""Says which numbers of each scheme a search for a tuning may choose, and between which bounds.

What a sensor is known to be is not searched: the variances of fixes and samples, the bias walk. A
scheme's estimates therefore keep honest standard deviations. Searched are the numbers that no data
sheet holds, and the structure of HME2's moving horizon estimator (MHE).
"""

from __future__ import annotations

from typing import Any

from owtsweep.studies.hub.config import HubConfig

#: Bounds of a filter's q_a, (m/s^3)^2/Hz, and of the factor on the variance of HME2's positions.
NOISE = (1e-3, 1e4)
SCALE = (1e-3, 1e3)
#: Longest smoother window, s, and longest window of the MHE, in GNSS intervals.
LONGEST_WINDOW = 1.0
LONGEST_HORIZON = 40
#: The MHE takes at most this many values of T_m: the longest of those that are allowed.
INTERVALS = 5

#: The structure of HME2's MHE in `tuning=matched`, the fullest that there is.
STRUCTURE = {"hme.mhe.arrival": "mkf", "hme.mhe.inputs": "all", "hme.mhe.weights": "full"}

#: [low, high, "log" or "int"], or the list of options.
Space = dict[str, Any]


def find_space(config: HubConfig, scheme: str) -> Space:
    """Return key -> its bounds or options, for the numbers of a scheme; {} for an unknown scheme.

    A key has the bounds [low, high, "log"] or [low, high, "int"], or a mapping with its `options`.
    """
    imu, gnss = config.sensors.imu, config.sensors.gnss
    window = [0, round(LONGEST_WINDOW * imu.rate), "int"]
    spaces: dict[str, Space] = {
        "EKF": {"ekf.q_a": [*NOISE, "log"]},
        "MKF": {"mkf.q_a": [*NOISE, "log"]},
        "HME1": {"hme1.q_a": [*NOISE, "log"], "hme.smoother_window": window},
        "HME2": {
            "hme2.q_a": [*NOISE, "log"],
            "hme2.r_gnss.scale": [*SCALE, "log"],
            "hme.mhe.smoother_window": window,
            "hme.mhe.horizon": [1, LONGEST_HORIZON, "int"],
            "hme.mhe.interval": {"options": list_intervals(imu.rate, gnss.rate)},
            "hme.mhe.arrival": {"options": ["mkf", "fixed", "none"]},
            "hme.mhe.inputs": {"options": ["all", "averaged", "sampled"]},
            "hme.mhe.weights": {"options": ["full", "diagonal"]},
        },
    }
    return spaces.get(scheme, {})


def list_intervals(imu_rate: float, gnss_rate: float) -> list[float]:
    """Return the longest allowed values of T_m, s: whole IMU steps that divide the GNSS interval.

    The rates are in Hz.
    """
    M = round(imu_rate / gnss_rate)
    steps = [n for n in range(M, 0, -1) if M % n == 0]
    return [n / imu_rate for n in steps[:INTERVALS]]
