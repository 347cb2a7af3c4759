"""The sections of the hub study's configuration that tune schemes: plain data, of no scheme."""

from __future__ import annotations

import math
from typing import Literal

from owtsweep.config import Finite, NotNegative, Positive, Section, key
from owtsweep.gravity import GRAVITY


class Variance(Section):
    """The variance of a measurement: computed by a rule from the sensor's sigma, times `scale`."""

    rule: Literal["sigma2", "sigma2_over_step", "sigma2_times_ratio"] = key(
        "sigma2: sigma^2; sigma2_over_step: sigma^2 / T_a, Eq. (10f) on a per-sample variance; "
        "sigma2_times_ratio: sigma^2 M with M = T_g / T_a"
    )
    scale: Positive = key("factor on the rule's variance")


class FixTuning(Section):
    """What a filter does with a fix that is far from its prediction."""

    fix_rule: Literal["plain", "gate", "huber"] = key(
        "plain: every fix counts alike; gate: a fix too far from its prediction is refused (not in "
        "HME2); huber: it counts less, in HME2 within the window's cost. With gate or huber the "
        "scheme is not linear",
        default="plain",
    )
    gate_probability: float = key(
        "fix_rule=gate: probability with which a fix without gross error passes (chi-square, with "
        "two degrees of freedom; with one in skf, which judges each axis by itself)",
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


class FilterTuning(FixTuning):
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
        "lean of the IMU per displacement that the filter assumes; auto (in a tuning file): "
        "sensors.imu.tilt",
        unit="rad/m",
        default=0.0,
    )
    r_gnss: Variance = key("variance of a fix")
    r_imu: Variance = key("variance of a sample")
    p0: list[Positive] = key(
        "initial variances of position, velocity, acceleration, bias",
        form="four finite variances above zero (position, velocity, acceleration, bias)",
        min_length=4,
        max_length=4,
    )


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
    """The settings of HME2's MHE."""

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
    def bounds(self) -> list[float]:
        """The largest magnitudes of position (m), velocity (m/s), bias (m/s^2); else infinite."""
        return [
            math.inf if limit is None else limit for _, limit in self.constraints or Constraints()
        ]


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


class Tuning(Section):
    """The sections that a tuning sets, for one of several tunings in a run."""

    ekf: FilterTuning = key("the filter of EKF")
    mkf: FilterTuning = key("the filter of MKF")
    hme1: FilterTuning = key("the filter of HME1")
    hme2: FilterTuning = key("the filter of HME2")
    hme: Hme = key("smoother of HME1 and HME2, MHE of HME2")


class Skf(FixTuning):
    """The settings of SKF, which is given the spectrum of the motion, and of SKFA, which tracks it.

    SKFA does not take states, natural_period and amplitude. Each axis judges a fix by itself.
    """

    fix_rule: Literal["plain", "gate", "huber"] | None = key(  # type: ignore[assignment]
        "as of the other filters; null: gate in SKFA, and plain in SKF, which then is linear",
        default=None,
    )
    gate_patience: int = key(
        "fix_rule=gate: fixes that are refused in a row; then every fix is taken until one lies "
        "within the gate, and SKFA gives up its spectrum",
        unit="fixes",
        default=10,
        ge=1,
    )

    states: int = key("of the shaping filter; even", default=16, ge=4, le=24)
    natural_period: Positive | None = key(
        "period of the peak of the spectrum that SKF is given; null: that of the cell of a sweep",
        unit="s",
        default=None,
    )
    amplitude: Positive | None = key(
        "amplitude of the motion that SKF is given; null: that of the cell of a sweep",
        unit="m",
        default=None,
    )
    tilt: Finite | None = key(
        "lean of the IMU per displacement that SKF assumes; null: the sensor's own",
        unit="rad/m",
        default=None,
    )
    bias_variance: Positive = key(
        "initial variance of the bias, gravity included", unit="(m/s^2)^2", default=0.01
    )
    q_b: NotNegative | None = key(
        "density of the bias walk; null: the sensor's own bias_walk^2",
        unit="(m/s^2)^2/s",
        default=None,
    )

    track_tilt: bool = key(
        "whether SKFA corrects the tilt by what fixes show of it, from `tilt` on", default=True
    )
    red_sigma: NotNegative | None = key(
        "standard deviation of the red noise that SKF and SKFA assume of fixes; null: none in SKF, "
        "and SKFA tracks it",
        unit="m",
        default=None,
    )
    red_time: Positive = key("correlation time of that red noise", unit="s", default=300.0)

    def find_lean(self, of_sensors: float) -> float:
        """Return g tilt in s^-2: by the key `tilt`, or `of_sensors` if that key is null."""
        return of_sensors if self.tilt is None else GRAVITY * self.tilt


class Switch(Section):
    """The settings of the scheme SWITCH, which hands out one of two schemes."""

    below: str = key("scheme below the boundary", default="HME2")
    above: str = key("scheme above the boundary", default="HME1")
    boundary: list[list[Positive]] | None = key(
        "pairs of natural period (s) and amplitude (m); null: where the expected errors of the two "
        "schemes are equal",
        default=None,
    )
    crest: Positive = key("amplitude of the motion per rms of the displacement", default=3.5)
    memory: Positive = key("memory of the estimated amplitude and period", unit="s", default=30.0)
    hysteresis: float = key(
        "factor on the boundary to switch upwards, and divisor to switch downwards",
        default=1.2,
        ge=1.0,
        le=100.0,
    )
    blend: NotNegative = key("time to pass from one scheme to the other", unit="s", default=5.0)
