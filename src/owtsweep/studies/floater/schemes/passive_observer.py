"""PASSIVE_OBSERVER: Fossen's non-linear passive observer, tuned by natural frequencies.

The paper compares its Kalman filters with such an observer, whose equations and gains it does not
print. This one is the public form (`owtsweep.estimation.passive_observer`), on positions alone. Its
model knows the natural frequencies; its cut-off is `filters.observer` times the one that balances
lag and noise, and above the waves in any case.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.estimation.passive_observer import choose_gains, find_growth, observe
from owtsweep.studies.base.contract import Unable
from owtsweep.studies.floater.contract import DOF, Estimates, Measured, Scheme, Setting
from owtsweep.studies.floater.schemes.linear import keep_reports
from owtsweep.studies.floater.schemes.lowpass import balance_lag_and_noise
from owtsweep.studies.floater.schemes.printed import find_start

#: Damping ratio of the slow motion in the observer's model.
DAMPING = 0.05


#: The cut-off is above the waves by this factor at least (Fossen 2011, section 11.4).
ABOVE = 1.22
#: Radians per sample of the fastest cut-off: steps of the observer are too coarse for more.
FASTEST = 0.6


def find_waves(setting: Setting) -> Array:
    """Return the frequency of each degree of freedom's fast part in rad/s, shape (6,).

    That is the mean one of its velocity, or the natural one if that is higher.
    """
    mean = setting.motion_sigma[2] / setting.motion_sigma[1]
    return np.asarray(np.maximum(setting.frequency, mean))


@dataclass(frozen=True)
class PassiveObserver:
    """The observer with its wave frequencies (6,) and gains (5, 6)."""

    setting: Setting
    waves: Array
    gains: Array

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the reports of a record."""
        reported = np.ascontiguousarray(keep_reports(self.setting, measured))
        position, velocity = np.empty_like(reported), np.empty_like(reported)
        observe(
            reported, measured.step, self.setting.frequency, np.full(len(DOF), DAMPING),
            self.waves, self.gains, find_start(reported.T)[:, 0].copy(), (position, velocity),
        )  # fmt: skip
        return Estimates(position, velocity)


class PassiveObserverScheme(Scheme):
    """The non-linear passive observer."""

    name = "PASSIVE_OBSERVER"

    def prepare(self, setting: Setting) -> PassiveObserver:
        """Choose the gains for a setting.

        Raises
        ------
        Unable
            If the observer is unstable with them.
        """
        waves = find_waves(setting)
        best = setting.tuning.observer * balance_lag_and_noise(setting)
        cutoff = np.clip(best, ABOVE * waves, np.maximum(FASTEST / setting.step, ABOVE * waves))
        gains = choose_gains(setting.frequency, waves, cutoff)
        for i, name in enumerate(DOF):
            growth = find_growth(setting.frequency[i], DAMPING, waves[i], gains[:, i], setting.step)
            if growth >= 1.0:
                raise Unable(
                    f"{self.name} is unstable in {name} at {1.0 / setting.step:g} Hz: its error "
                    f"grows by {growth:.3g} per sample; a higher record.rate or a lower "
                    "filters.observer may help"
                )
        return PassiveObserver(setting, waves, gains)


SCHEME = PassiveObserverScheme()
