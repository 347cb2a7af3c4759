"""What the paper leaves open: readings, which are choices, and settings, which have priors.

A filter's gains depend on ratios of its covariances alone, so the variance of the IMU is the unit
of the others and one number less is free. All priors are uniform in the logarithm.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from experiments.ren2019.evidence import SCHEMES
from owtsweep.arrays import Array

#: Variance of an IMU sample that filters are told, (m/s^2)^2: sigma^2 of Table 5.
IMU_VARIANCE = 0.15**2
#: Variance of a fix, m^2: sigma^2 of Table 5.
FIX_VARIANCE = 0.03**2


class Setting(NamedTuple):
    """A number that the paper does not state: its name, and the ends of its prior."""

    name: str
    low: float
    high: float
    unit: str


#: Settings of the filter that MKF, HME1 and HME2 share (section 4.2), per variance of the IMU.
_SHARED = (
    Setting("q_a", 1.0, 1e4, "1/s^2/Hz"),
    Setting("q_b", 1e-9, 1e-3, "1/s"),
    Setting("p0", 1e-2, 1e3, "-"),
)
FILTER = (*_SHARED, Setting("r_gnss", 1e-3, 1e1, "s^4"))
SMOOTHER = (Setting("smoother_window", 2.0, 60.0, "steps"),)
#: HME2's own: the variance of the MHE's positions, and the MHE's window and link weights.
MHE = (
    Setting("hme2_r_gnss", 1e-3, 1e1, "s^4"),
    Setting("horizon", 4.0, 40.0, "fixes"),
    Setting("mhe_q_a", 1e-4, 1e-1, "(m/s^2)^2/Hz"),
    Setting("mhe_q_b", 1e-9, 1e-4, "(m/s^2)^2/s"),
)
#: The EKF's filter, per variance of the IMU. Eq. (10f) makes that of the fixes the smaller.
EKF = (
    Setting("ekf_q_a", 1e-1, 1e4, "1/s^2/Hz"),
    Setting("ekf_q_b", 1e-9, 1e-3, "1/s"),
    Setting("ekf_p0", 1e-2, 1e3, "-"),
    Setting("ekf_r_gnss", 1e-5, 1e1, "s^4"),
)
#: The truth of the simulation: the IMU's bias.
TRUTH = (
    Setting("bias_walk", 1e-5, 1e-2, "m/s^2/sqrt(s)"),
    Setting("bias_initial", 1e-3, 3e-1, "m/s^2"),
)
#: Scheme -> the settings on which its gains depend.
OF_SCHEME = {
    "EKF": EKF,
    "MKF": FILTER,
    "HME1": (*FILTER, *SMOOTHER),
    "HME2": (*_SHARED, *SMOOTHER, *MHE),
}
SETTINGS = (*EKF, *FILTER, *SMOOTHER, *MHE, *TRUTH)
NAMES = [setting.name for setting in SETTINGS]
assert tuple(OF_SCHEME) == SCHEMES

#: Standard deviation of the half-normal prior of each scheme's discrepancy, in the logarithm.
DISCREPANCY = 0.3

#: Ends of records, s, and the time at the start that may be left out of a mean.
LENGTHS = (200.0, 400.0, 1000.0, 2000.0)
SETTLING = 20.0
#: What the IMU feels of the motion -> overrides. The lean is the monopile's of the paper's Table 2;
#: outwards, gravity adds to what a level IMU would feel of an outward motion (`Sensors.lean`).
FORCES: dict[str, dict[str, object]] = {
    "level": {},
    "leaning": {"sensors.imu.tilt": 0.0137},
    "against": {"sensors.imu.tilt": -0.0137},
    "coupled": {"sensors.imu.high_pass": 0.01},
    "coupled_high": {"sensors.imu.high_pass": 0.05},
}
#: Which motion -> overrides. Table 4's digits allow a k (the peak's width) between the two ends
#: that `narrow` and `wide` have; the band's upper edge is stated nowhere, .6 Hz is this package's.
SPECTRA: dict[str, dict[str, object]] = {
    "middle": {},
    "narrow": {"spectrum.bandwidth": 1.0204e-4},
    "wide": {"spectrum.bandwidth": 5.556e-4},
    "broad": {"band": [0.05, 2.0]},
}
#: Pairs of a force and a spectrum that are simulated: spectra are varied for two forces.
MOTIONS = [
    *((force, "middle") for force in FORCES),
    *((force, spectrum) for force in ("level", "against") for spectrum in list(SPECTRA)[1:]),
]
#: What "+-" in Table 5 states -> the standard deviation per stated number.
ACCURACIES = {"sigma": 1.0, "uniform": 3.0**-0.5, "three_sigma": 1.0 / 3.0}


@dataclass(frozen=True)
class Reading:
    """A choice for all that the paper leaves open and that is no number.

    accuracy: what "+-" in Table 5 means, see `ACCURACIES`.
    length: of the record, s; one of `LENGTHS`.
    start: whether the first `SETTLING` seconds count.
    force: what the IMU feels, see `FORCES`.
    spectrum: of the motion, see `SPECTRA`.
    seeds: own, or shared: whether the four tables share the random numbers of one record.
    """

    accuracy: str = "sigma"
    length: float = 1000.0
    start: bool = True
    force: str = "level"
    spectrum: str = "middle"
    seeds: str = "own"

    def __str__(self) -> str:
        start = "start" if self.start else "settled"
        motion = f"{self.force}, {self.spectrum} spectrum"
        return f"{self.accuracy}, {self.length:g} s, {start}, {motion}, {self.seeds} seeds"

    @property
    def motion(self) -> dict[str, object]:
        """Overrides of the configuration: what moves, and what the IMU feels of it."""
        return {**FORCES[self.force], **SPECTRA[self.spectrum]}


def from_unit(unit: Array, settings: tuple[Setting, ...] = SETTINGS) -> Array:
    """Turn numbers in [0, 1], shape (..., settings), into values of the settings."""
    low = np.log([setting.low for setting in settings])
    high = np.log([setting.high for setting in settings])
    return np.asarray(np.exp(low + unit * (high - low)))


def columns_of(scheme: str) -> list[int]:
    """Return the positions in `SETTINGS` of a scheme's settings."""
    return [NAMES.index(setting.name) for setting in OF_SCHEME[scheme]]


def make_tuning(scheme: str, values: dict[str, float]) -> dict[str, object]:
    """Return the configuration's overrides for a scheme's settings; key -> value."""
    if scheme == "EKF":
        values = {name.removeprefix("ekf_"): value for name, value in values.items()}
    fix = values["hme2_r_gnss"] if scheme == "HME2" else values["r_gnss"]
    section = scheme.lower()
    made: dict[str, object] = {
        f"{section}.q_a": values["q_a"] * IMU_VARIANCE,
        f"{section}.q_b": values["q_b"] * IMU_VARIANCE,
        f"{section}.p0": [values["p0"] * IMU_VARIANCE] * 4,
        f"{section}.r_imu": {"rule": "sigma2", "scale": 1.0},
        f"{section}.r_gnss": {"rule": "sigma2", "scale": fix * IMU_VARIANCE / FIX_VARIANCE},
    }
    if "smoother_window" in values:
        made["hme.smoother_window"] = round(values["smoother_window"])
    if scheme == "HME2":
        made["hme.mhe.horizon"] = round(values["horizon"])
        made["hme.mhe.q_a"] = values["mhe_q_a"]
        made["hme.mhe.q_b"] = values["mhe_q_b"]
    return made
