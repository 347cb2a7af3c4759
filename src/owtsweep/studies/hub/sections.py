"""The sections of the hub-motion study's configuration: their keys, types, bounds and meanings.

Units are SI, but angles (yaw) are in degrees.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field

from owtsweep.config import Axis, Finite, NotNegative, Positive, Section, key
from owtsweep.config.section import require_magnitude
from owtsweep.gravity import GRAVITY
from owtsweep.structures.description import ANGLES
from owtsweep.studies.hub.gnss import Gnss

#: Value of `sensors.imu.tilt`: the IMU leans as the structure does, mode by mode.
STRUCTURE = "structure"


def _read_tilt(value: Any) -> float | str:
    """Return a tilt in rad/m, or the word `structure`."""
    if value == STRUCTURE:
        return STRUCTURE
    try:
        number = float(value)
    except (TypeError, ValueError):
        raise ValueError(f"{value!r} is neither a number nor the word {STRUCTURE}") from None
    if not math.isfinite(number):
        raise ValueError(f"{number:g} rad/m must be a finite number")
    return require_magnitude(number)


#: A tilt in rad/m, or the word `structure`.
Tilt = Annotated[float | str, BeforeValidator(_read_tilt)]


class Grid(Section):
    """The axes of the sweep: the values of each condition, and the number of replicates."""

    natural_period: Axis[Positive] = key("natural periods of the turbine", unit="s")
    amplitude: Axis[Positive] = key("largest displacement of a record (normalise: peak)", unit="m")
    replicates: int = key("records per cell of the grid", ge=1, le=1_000_000)


class MotionConfig(Section):
    """Where the motion comes from: a spectrum, or a structure under waves (the plant).

    All keys but `kind` and `envelope` belong to the plant; sea states and blades are null without a
    plant.
    """

    kind: Literal["spectrum", "plant"] = key(
        "spectrum: the spectrum of the key `spectrum`; plant: the structure of the key `structure` "
        "under waves (choose by motion=plant)",
        default="spectrum",
    )
    hs: Axis[Positive] | None = key(
        "significant wave heights of the sea states", unit="m", default=None
    )
    tp: Axis[Positive] | None = key("peak periods of the sea states", unit="s", default=None)
    blades: Axis[Annotated[int, Field(ge=0, le=3)]] | None = key("mounted blades", default=None)
    friction_angle: Axis[Annotated[float, Field(ge=ANGLES[0], le=ANGLES[1])]] | None = key(
        "angles of internal friction, each set in every layer of the soil; null: the structure's "
        "own layers",
        unit="deg",
        default=None,
    )
    gamma: float = key("peak enhancement factor of the JONSWAP spectrum", default=3.3, ge=1, le=10)
    modes: int = key("modes of the structure that answer", default=4, ge=1)
    damping: float | None = key(
        "damping ratio of every mode; null: the structure's own", default=None, gt=0.0, lt=1.0
    )
    envelope: list[list[Finite]] | None = key(
        "pairs of time (s) and factor on the amplitude, e.g. [[0,0.1],[1000,10]]: a sea that grows "
        "and falls (motion=spectrum only); null: none",
        default=None,
    )


class Record(Section):
    """The length of a record of motion and measurements."""

    duration: Positive = key("length of a record", unit="s")


class SpectrumConfig(Section):
    """The spectrum of the motion."""

    kind: Literal["translated", "printed"] = key(
        "translated: one peak moved along the frequency axis; printed: Table 4 as it stands"
    )
    bandwidth: Positive = key(
        "k, the squared half-bandwidth of the peak (translated only)", unit="s^-2"
    )


class Imu(Section):
    """The properties of the accelerometers, the IMU."""

    sigma: Positive = key("standard deviation of a sample, per axis", unit="m/s^2")
    rate: Positive = key("samples per second", unit="Hz")
    bias_initial: Finite = key("bias at the start of a record, per axis", unit="m/s^2")
    bias_walk: NotNegative = key("intensity of the bias' random walk", unit="m/s^2/sqrt(s)")
    tilt: Tilt = key(
        "lean of the IMU per displacement; above zero: it leans the way that it moves, so the "
        "specific force is a - g tilt d; `structure`: as the structure leans, mode by mode "
        "(motion=plant only)",
        unit="rad/m",
        default=0.0,
    )
    high_pass: Positive | None = key(
        "corner of an AC coupling, a first-order high-pass of what the IMU feels of the motion "
        "(its noise and bias do not pass it); null: none",
        unit="Hz",
        default=None,
    )


class SensorConfig(Section):
    """The sensors, GNSS and IMU, and the orientation of the IMU."""

    gnss: Gnss = key("the position sensor")
    imu: Imu = key("the accelerometers")
    accuracy: Literal["sigma", "bound"] = key(
        "what gnss.sigma and imu.sigma are: standard deviations (sigma) or, as the plus-minus "
        "signs of Table 5 may mean, bounds of three standard deviations (bound)"
    )
    yaw: Finite = key("fixed yaw of the IMU", unit="deg")
    gravity: list[Finite] = key(
        "horizontal part of gravity, north and east",
        unit="m/s^2",
        form="two numbers, north and east, in m/s^2",
        min_length=2,
        max_length=2,
    )


class Variance(Section):
    """The variance of a measurement: computed by a rule from the sensor's sigma, times `scale`."""

    rule: Literal["sigma2", "sigma2_over_step", "sigma2_times_ratio"] = key(
        "sigma2: sigma^2; sigma2_over_step: sigma^2 / T_a, Eq. (10f) on a per-sample variance; "
        "sigma2_times_ratio: sigma^2 M with M = T_g / T_a"
    )
    scale: Positive = key("factor on the rule's variance")


class FilterTuning(Section):
    """The tuning of one Kalman filter: model, discretisation, update rule and covariances."""

    model: Literal["sigma1", "sigma2"] = key(
        "Sigma_1 estimates the acceleration; Sigma_2 takes it as an input"
    )
    discretisation: Literal["exact", "first_order"] = key("exact, or first order as Eq. (10c-e)")
    update_rule: Literal["proper", "mask_columns", "mask_rows", "every_step"] = key(
        "between fixes: proper updates by the IMU alone; mask_columns and mask_rows zero columns "
        "or rows of the gain; every_step updates the covariance as if there were a fix"
    )
    q_a: NotNegative = key(
        "density of the white noise that drives the acceleration of Sigma_1; not used by Sigma_2",
        unit="(m/s^3)^2/Hz",
    )
    q_b: NotNegative | None = key(
        "density of the bias walk; null: the sensor's own bias_walk^2", unit="(m/s^2)^2/s"
    )
    tilt: Finite = key(
        "lean of the IMU per displacement that the filter believes in; auto (in a tuning file): "
        "sensors.imu.tilt",
        unit="rad/m",
        default=0.0,
    )
    fix_rule: Literal["plain", "gate", "huber"] = key(
        "plain: every fix counts alike; gate: a fix too far from its prediction is refused (not in "
        "HME2); huber: it counts less, in HME2 within the window's cost. With gate or huber the "
        "scheme is not linear",
        default="plain",
    )
    gate_probability: float = key(
        "fix_rule=gate: probability with which a fix without gross error passes (chi-square, two "
        "degrees of freedom)",
        default=0.999,
        gt=0.0,
        lt=1.0,
    )
    gate_patience: int = key(
        "fix_rule=gate: fixes that are refused in a row; then every fix is taken until one lies "
        "within the gate, for the state must be wrong",
        unit="fixes",
        default=1,
        ge=1,
    )
    huber_limit: Positive = key(
        "fix_rule=huber: distance beyond which the weight of a fix falls as 1 / distance",
        unit="standard deviations",
        default=2.0,
    )
    r_gnss: Variance = key("variance of a fix")
    r_imu: Variance = key("variance of a sample")
    p0: list[Positive] = key(
        "initial variances of position, velocity, acceleration, bias",
        form="four finite variances above zero (position, velocity, acceleration, bias)",
        min_length=4,
        max_length=4,
    )

    @property
    def lean(self) -> float:
        """The specific force by leaning, g tilt, in m/s^2 per metre of displacement."""
        return GRAVITY * self.tilt


class Constraints(Section):
    """The bounds of the states in the MHE's window: largest magnitudes of the components."""

    position: Positive | None = key(
        "of the hub, north and east; null: none", unit="m", default=None
    )
    velocity: Positive | None = key(
        "of the hub, north and east; null: none", unit="m/s", default=None
    )
    #: b^b = R' (g - x4), since x4 = -R b^b + g in Eq. (6).
    bias: Positive | None = key(
        "of the IMU in its own frame, as its data sheet states it; null: none",
        unit="m/s^2",
        default=None,
    )


class Mhe(Section):
    """The settings of the moving horizon estimator (MHE) of HME2."""

    interval: Positive = key(
        "T_m; whole IMU steps whose number divides the GNSS interval", unit="s"
    )
    horizon: int = key("N_m, length of the window", unit="GNSS interval", ge=1, le=1_000_000)
    arrival: Literal["mkf", "fixed", "none"] = key(
        "x_m0: a prior from the scheme's own past (mkf), the oldest state itself (fixed), or none"
    )
    inputs: Literal["all", "averaged", "sampled"] = key(
        "every IMU sample, the mean of the last T_m held for the next, or one sample per T_m held"
    )
    weights: Literal["diagonal", "full"] = key("diagonal as printed, or full")
    q_a: Positive | None = key(
        "density of the accelerometer's noise behind the link weights; null: the sensor's own",
        unit="(m/s^2)^2/Hz",
    )
    q_b: Positive | None = key(
        "density of the bias walk behind the link weights; null: the sensor's own",
        unit="(m/s^2)^2/s",
    )
    r_fix: Variance = key("variance of a fix")
    p0: list[Positive] = key(
        "initial variances of position, velocity, bias",
        form="three finite variances above zero (position, velocity, bias)",
        min_length=3,
        max_length=3,
    )
    smoother_window: int | None = key(
        "HME2's own N_s; null: hme.smoother_window",
        unit="IMU steps",
        ge=0,
        advice="use 0 for no smoother",
    )
    solver: Literal["qrqp", "ipopt"] = key("of each MHE problem in the reference engine")
    constraints: Constraints | None = key(
        "bounds on the window's states; with any of them HME2 is not linear", default=None
    )

    @property
    def bounds(self) -> tuple[float, float, float]:
        """The largest allowed magnitudes of position (m), velocity (m/s) and bias (m/s^2).

        A magnitude that is not bounded is infinite.
        """
        limits = self.constraints or Constraints()
        values = (limits.position, limits.velocity, limits.bias)
        p, v, b = (float("inf") if value is None else value for value in values)
        return p, v, b


class Predictor(Section):
    """The settings of the predictor of HME1 and HME2, Algorithm 9 of Ren et al. (2019)."""

    hold: Literal["zero", "first"] = key(
        "specific force between two IMU samples: zero: the older sample, as in the paper; first: "
        "linear from sample to sample",
        default="zero",
    )


class Hme(Section):
    """The settings that HME1 and HME2 share, and the settings of HME2's MHE."""

    smoother_window: int = key(
        "N_s of the fixed-lag smoother", unit="IMU steps", ge=0, advice="use 0 for no smoother"
    )
    mhe: Mhe = key("the moving horizon estimator of HME2")
    predictor: Predictor = key("the predictor", default=Predictor())


class Measures(Section):
    """The measures to compute, and the criterion by which schemes are ranked."""

    settling_time: NotNegative = key("left out of the window settled", unit="s")
    window: Literal["full", "settled"] = key("the window that the map judges")
    criterion: Literal["position", "velocity", "x", "y"] = key(
        "the MSE that the map judges: position is x + y, velocity is vx + vy"
    )
    extremes: bool = key(
        "also the largest and the 95th percentile position error; needs evaluation=direct"
    )
    efficiency: bool = key(
        "also how near the schemes come to the bounds of the settled position and velocity MSE: "
        "columns efficiency_a and efficiency_b of summary.csv, and a figure",
        default=False,
    )


class Tuning(Section):
    """The sections that a tuning sets, for one of several tunings in a run."""

    ekf: FilterTuning = key("the filter of EKF")
    mkf: FilterTuning = key("the filter of MKF")
    hme1: FilterTuning = key("the filter of HME1")
    hme2: FilterTuning = key("the filter of HME2")
    hme: Hme = key("smoother of HME1 and HME2, MHE of HME2")
