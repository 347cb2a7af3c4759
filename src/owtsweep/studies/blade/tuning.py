"""The numbers of the blade study's schemes, as one section of the configuration.

`paper` assumes Table 1 of Maes et al. (2018), whatever the sensors are; `matched` gives every
scheme the truth.
"""

from __future__ import annotations

from typing import Literal

from owtsweep.config import NotNegative, Positive, Section, key
from owtsweep.studies.base.keys import key_of_vector
from owtsweep.studies.base.searching import Searched


class Tuning(Section):
    """The section `filters`: what schemes assume, and their own numbers."""

    noise: Literal["declared", "truth"] = key(
        "where the noise of GNSS and inertial unit is from: the numbers below, or the sensors' own"
    )
    fix_sigma: list[Positive] = key_of_vector("declared noise of a fix, three numbers", "m")
    force_sigma: Positive = key("declared noise of a sample of accelerometers", unit="m/s^2")
    force_bias: Positive = key("declared bias of accelerometers", unit="m/s^2")
    force_walk: NotNegative = key("declared change of that bias in 100 s", unit="m/s^2")
    rate_sigma: Positive = key("declared noise of a sample of gyroscopes", unit="deg/s")
    rate_bias: Positive = key("declared bias of gyroscopes", unit="deg/s")
    rate_walk: NotNegative = key("declared change of that bias in 100 s", unit="deg/s")
    offset_sigma: Positive = key(
        "how late GNSS time stamps may come, for the scheme with that offset as a state", unit="s"
    )
    lever_sigma: Positive = key(
        "how far along each axis the antenna may stand elsewhere, for the scheme with the error of "
        "its place as states",
        unit="m",
        default=0.1,
    )
    agreement: Positive = key(
        "standard deviation with which the hook's swing and the navigation agree", unit="m"
    )
    lag: NotNegative = key("of the fixed-lag smoother", unit="s")
    crossover: Positive = key(
        "crossover of the complementary filter over the one that balances noise of GNSS and "
        "accelerometers"
    )
    levelling: Positive = key(
        "time constant with which the complementary filter levels its attitude", unit="s"
    )


#: What `tune` searches.
SEARCHED = (
    Searched(
        ("COMPLEMENTARY",),
        {"filters.crossover": [0.1, 10.0, "log"], "filters.levelling": [5.0, 600.0, "log"]},
    ),
    Searched(("PENDULUM",), {"filters.agreement": [1e-3, 0.3, "log"]}),
    Searched(("MEKF_OFFSET",), {"filters.offset_sigma": [1e-2, 2.0, "log"]}),
    Searched(("MEKF_LEVER",), {"filters.lever_sigma": [1e-3, 1.0, "log"]}),
)
