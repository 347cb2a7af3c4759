"""FIXED_LAG: KF_REPAIRED with a smoother; estimates wait for what arrives within filters.lag.

A delay of the optical system eats up the lag: with a delay of the lag, this is KF_REPAIRED without
delay, an interval late; with a longer one, it predicts by what is left.
"""

from __future__ import annotations

from dataclasses import dataclass

from owtsweep.estimation.kinematic_filter import smooth_all
from owtsweep.studies.floater.contract import Estimates, Measured, Scheme, Setting
from owtsweep.studies.floater.schemes.linear import Linear, report


@dataclass(frozen=True)
class FixedLag:
    """A smoother made ready for a setting."""

    filter: Linear

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        lag = round(self.filter.setting.tuning.lag / measured.step)
        return report(smooth_all(*self.filter.read(measured), lag), wait=lag * measured.step)


class FixedLagScheme(Scheme):
    """The smoother of fixed lag."""

    name = "FIXED_LAG"

    def prepare(self, setting: Setting) -> FixedLag:
        """Make the smoother ready for a setting."""
        return FixedLag(Linear(setting, bias=True, delay=True))


SCHEME = FixedLagScheme()
