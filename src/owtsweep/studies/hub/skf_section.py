"""The section `skf` of the configuration: what SKF and SKFA believe."""

from __future__ import annotations

from owtsweep.config import Finite, NotNegative, Positive, Section, key
from owtsweep.gravity import GRAVITY


class Skf(Section):
    """The settings of SKF, which is told the spectrum of the motion, and of SKFA, which tracks it.

    SKFA takes tilt, bias_variance and q_b alone.
    """

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
        "lean of the IMU per displacement that SKF believes in; null: the sensor's own",
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

    def find_lean(self, of_sensors: float) -> float:
        """Return g tilt in s^-2: by the key `tilt`, or `of_sensors` if that key is null."""
        return of_sensors if self.tilt is None else GRAVITY * self.tilt
