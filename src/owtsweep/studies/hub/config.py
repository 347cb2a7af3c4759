"""The configuration of the hub-motion study: its keys, types and what can work.

Units are SI; angles are in degrees, as users state a yaw or a wave direction.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from owtsweep.config import YOUNGER, Config


@dataclass(frozen=True, kw_only=True)
class Grid:
    """The axes of the sweep: natural period (s), amplitude (m), number of replicates."""

    natural_period: list[float]
    amplitude: list[float]
    replicates: int


@dataclass(frozen=True, kw_only=True)
class Record:
    """`duration` of a record, s."""

    duration: float


@dataclass(frozen=True, kw_only=True)
class SpectrumConfig:
    """`kind` translated or printed; `bandwidth` k in s^-2 (translated only)."""

    kind: str
    bandwidth: float


@dataclass(frozen=True, kw_only=True)
class Gnss:
    """`sigma` m per fix and axis, `rate` Hz, `delay` s."""

    sigma: float
    rate: float
    delay: float


@dataclass(frozen=True, kw_only=True)
class Imu:
    """`sigma` m/s^2 per sample and axis, `rate` Hz, bias: initial m/s^2, walk m/s^2/sqrt(s)."""

    sigma: float
    rate: float
    bias_initial: float
    bias_walk: float


@dataclass(frozen=True, kw_only=True)
class SensorConfig:
    """GNSS, IMU, the fixed `yaw` of the IMU (deg), horizontal gravity in NED (m/s^2).

    `accuracy`: whether gnss.sigma and imu.sigma are standard deviations ("sigma") or, as the
    plus-minus signs of Table 5 may mean, bounds of three standard deviations ("bound").
    """

    gnss: Gnss
    imu: Imu
    accuracy: str
    yaw: float
    gravity: list[float]


@dataclass(frozen=True, kw_only=True)
class Variance:
    """A measurement variance by its rule from the sensor's sigma, times `scale`.

    `sigma2`: sigma^2. `sigma2_over_step`: sigma^2 / T_a, Eq. (10f) on a per-sample variance.
    `sigma2_times_ratio`: sigma^2 M with M = T_g / T_a.
    """

    rule: str
    scale: float


@dataclass(frozen=True, kw_only=True)
class FilterTuning:
    """One Kalman filter: model, discretisation, update rule and covariances.

    `q_a`: density of the white noise that drives the acceleration of Sigma_1, (m/s^3)^2/Hz (not
    used by Sigma_2). `q_b`: density of the bias walk, (m/s^2)^2/s; null takes the sensor's own
    bias_walk^2. `p0`: initial variances of position, velocity, acceleration, bias.
    """

    model: str
    discretisation: str
    update_rule: str
    q_a: float
    q_b: float | None
    r_gnss: Variance
    r_imu: Variance
    p0: list[float]


@dataclass(frozen=True, kw_only=True)
class Constraints:
    """Bounds on the states of the MHE's window, each component's magnitude; null for none.

    `position` (m) and `velocity` (m/s) in NED, as the hub may move. `bias` (m/s^2) of the IMU in
    its own frame, as its data sheet states it: b^b = R' (g - x4), since x4 = -R b^b + g in Eq. (6).
    """

    position: float | None = field(default=None, metadata=YOUNGER)
    velocity: float | None = field(default=None, metadata=YOUNGER)
    bias: float | None = field(default=None, metadata=YOUNGER)

    @property
    def bounds(self) -> tuple[float, float, float]:
        """Of position, velocity and bias; infinite where there is none."""
        values = (self.position, self.velocity, self.bias)
        p, v, b = (float("inf") if value is None else value for value in values)
        return p, v, b


@dataclass(frozen=True, kw_only=True)
class Mhe:
    """The moving horizon estimator of HME2.

    `interval`: T_m, s. `horizon`: N_m, GNSS intervals. `arrival`: x_m0 as a prior (mkf), as the
    oldest state itself (fixed) or ignored (none). `inputs`: every
    IMU sample ("all"), the mean of the last T_m held for the next ("averaged"), or one sample per
    T_m held ("sampled"). `weights`: "diagonal" as printed or "full". `q_a`, `q_b`: densities of
    accelerometer noise and bias walk behind the link weights; null takes the sensor's own.
    `r_fix`: variance of a fix. `p0`: initial variances of position, velocity, bias.
    `smoother_window`: HME2's own N_s; null takes hme.smoother_window. `solver`: qrqp or ipopt
    (reference engine). `constraints`: bounds on the window's states; with any of them HME2 is not
    linear.
    """

    interval: float
    horizon: int
    arrival: str
    inputs: str
    weights: str
    q_a: float | None
    q_b: float | None
    r_fix: Variance
    p0: list[float]
    smoother_window: int | None
    solver: str
    constraints: Constraints | None = field(default=None, metadata=YOUNGER)

    @property
    def bounds(self) -> tuple[float, float, float]:
        """Of |p|, |v| and |b^b|; infinite where there is none."""
        return (self.constraints or Constraints()).bounds


@dataclass(frozen=True, kw_only=True)
class Hme:
    """What HME1 and HME2 share: `smoother_window` N_s in IMU steps; `mhe`."""

    smoother_window: int
    mhe: Mhe


@dataclass(frozen=True, kw_only=True)
class Measures:
    """`settling_time` s; `window` (full or settled) and `criterion` for the map; `extremes`.

    `criterion`: the MSE that the map judges: position (x + y), velocity (vx + vy), x or y.
    """

    settling_time: float
    window: str
    criterion: str
    extremes: bool


@dataclass(frozen=True, kw_only=True)
class HubConfig(Config):
    """All keys of the hub-motion study."""

    evaluation: str
    grid: Grid
    record: Record
    spectrum: SpectrumConfig
    normalise: str
    band: list[float]
    wave_direction: float
    sensors: SensorConfig
    tuning: str
    schemes: list[Any]
    ekf: FilterTuning
    mkf: FilterTuning
    hme1: FilterTuning
    hme2: FilterTuning
    hme: Hme
    measures: Measures

    def check(self) -> None:
        super().check()
        from owtsweep.studies.hub.checks import check

        check(self)
