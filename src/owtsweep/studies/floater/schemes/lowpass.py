"""LOWPASS: reported positions through a low-pass filter, and their numerical derivative.

This is what people use first. A Butterworth filter of order 2 runs over the reports as they come (a
sample without one keeps the last), and the velocity is the backward difference of its output. Its
cut-off is `filters.cutoff` times the one that balances lag and noise. Both are late by sqrt(2) over
the cut-off's angular frequency, the velocity by half a step more.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.studies.floater.attitude import hold
from owtsweep.studies.floater.contract import Estimates, Measured, Scheme, Setting
from owtsweep.studies.floater.schemes.linear import keep_reports

#: The cut-off is at most this part of the sampling frequency: a digital filter ends at a half.
MOST = 0.45


@dataclass(frozen=True)
class LowPass:
    """The filter, made ready for one setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the reports of a record."""
        from scipy.signal import butter, lfilter, lfilter_zi

        setting, step = self.setting, measured.step
        reported = hold(keep_reports(setting, measured))
        position = np.empty_like(reported)
        best = balance_lag_and_noise(setting) / (2.0 * np.pi)
        for column, cutoff in enumerate(np.minimum(setting.tuning.cutoff * best, MOST / step)):
            b, a = butter(2, cutoff, fs=1.0 / step)
            begin = lfilter_zi(b, a) * reported[0, column]
            position[:, column] = lfilter(b, a, reported[:, column], zi=begin)[0]
        velocity = np.diff(position, axis=0, prepend=position[:1]) / step
        return Estimates(position, velocity)


def balance_lag_and_noise(setting: Setting) -> Array:
    """Return the cut-off in rad/s that is best for the velocity, shape (6,).

    A Butterworth filter of order 2 with the cut-off w is late by sqrt(2) / w, which moves the
    velocity by sqrt(2) / w times the acceleration. White noise of the variance R in reports at
    intervals h gives its derivative the variance R h w^3 / sqrt(8). The sum is least at

        w^5 = 8 sqrt(2) / 3 x sigma_a^2 / (R h)

    with the standard deviation sigma_a of the motion's acceleration.
    """
    ratio = setting.motion_sigma[2] / setting.position_sigma
    return np.asarray((8.0 * np.sqrt(2.0) / 3.0 * ratio**2 / setting.step) ** 0.2)


class LowPassScheme(Scheme):
    """Low-pass filter and numerical differentiation."""

    name = "LOWPASS"

    def prepare(self, setting: Setting) -> LowPass:
        """Make the filter ready for a setting."""
        return LowPass(setting)


SCHEME = LowPassScheme()
