"""UKF: the unscented Kalman filter on 15 errors, what the paper's system runs (section 2.1)."""

from __future__ import annotations

from dataclasses import dataclass

from owtsweep.estimation.inertial_unscented import filter_unscented
from owtsweep.studies.blade.contract import Direct, Estimates, Measured, Setting
from owtsweep.studies.blade.schemes.navigation import (
    begin,
    find_noise,
    find_variance,
    make_room,
    report,
)


@dataclass(frozen=True)
class Unscented:
    """The filter, made ready for a setting."""

    setting: Setting

    def run(self, measured: Measured) -> Estimates:
        """Estimate from the measurements of a record."""
        found = make_room(measured)
        filter_unscented(
            measured.fixes[:, :1].copy(), self.setting.geometry.levers[:1],
            find_variance(self.setting, measured), measured.due, measured.specific_force,
            measured.rate, measured.step, find_noise(self.setting),
            begin(self.setting), tuple(found),
        )  # fmt: skip
        return report(self.setting, measured, found)


SCHEME = Direct("UKF", Unscented)
