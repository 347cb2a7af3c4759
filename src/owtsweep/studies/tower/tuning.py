"""The numbers of the tower study's schemes, as one section of the configuration.

Simpson et al. (2025) tuned by trial and print no number (section 3). `paper` declares a rule of
ours: one variance for all states on mass-normalised modes, and round numbers for loads. `matched`
takes the loads' changes from the truth.
"""

from __future__ import annotations

from typing import Literal

from owtsweep.config import NotNegative, Positive, Section, key
from owtsweep.studies.base.searching import Searched


class Tuning(Section):
    """The section `filters`: covariances of all schemes."""

    inputs: Literal["declared", "truth"] = key(
        "where the loads' statistics are from: the numbers below, or the record's true loads"
    )
    process_noise: Positive = key(
        "variance per step of every state on mass-normalised modes, Q of Eq. (24)", unit="kg m^2"
    )
    rate_noise: Positive | None = key(
        "variance per step of the rates of these modes, where it differs from process_noise; null: "
        "it does not",
        unit="kg m^2/s^2",
        default=None,
    )
    rate_noise_in_waves: Positive | None = key(
        "the same in waves, whose loads no input describes wholly; null: as rate_noise",
        unit="kg m^2/s^2",
        default=None,
    )
    initial: Positive = key(
        "initial variance of every state on mass-normalised modes, P_0", unit="kg m^2"
    )
    force: Positive = key("change of an interface force per step, standard deviation", unit="N")
    moment: Positive = key("change of an interface moment per step", unit="N m")
    wave: Positive = key("change of the wave load at sea level per step", unit="N/m")
    correlation_time: Positive = key("of latent forces", unit="s")
    lag: NotNegative = key("of the fixed-lag smoother", unit="s")

    def find_rate_noise(self, waves: bool) -> float:
        """Return the variance per step of the rates of mass-normalised modes."""
        in_waves = self.rate_noise_in_waves if waves else None
        return in_waves or self.rate_noise or self.process_noise  # none of them is ever 0


#: The filters on the modes of the substructure or of the whole turbine.
MODAL = (
    "AKF", "AKF_WAVE", "AKF_STEADY", "AKF_LAGGED", "AKF_MATERN12", "AKF_MATERN32", "GDF", "DUAL",
    "AKF_WHOLE", "AKF_WHOLE_WAVE", "KF_WHOLE",
)  # fmt: skip


#: What `tune` searches. Numbers that `null` leaves out are not.
SEARCHED = (
    Searched(
        MODAL,
        {"filters.rate_noise": [1e-6, 1e2, "log"]},
        lambda config: config.waves.hs == 0.0 and config.filters.rate_noise is not None,
    ),
    Searched(
        MODAL,
        {"filters.rate_noise_in_waves": [1e-4, 1e4, "log"]},
        lambda config: config.waves.hs > 0.0 and config.filters.rate_noise_in_waves is not None,
    ),
    Searched(
        MODAL,
        {"filters.force": [1e1, 1e7, "log"], "filters.moment": [1e3, 1e9, "log"]},
        lambda config: config.filters.inputs == "declared",
    ),
)
