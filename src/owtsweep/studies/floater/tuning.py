"""The numbers of the floater study's schemes, as one section of the configuration.

`paper` is what Mehammer et al. (2018) and the author's code do; `matched` gives every scheme the
truth about noise, bias, delay and losses.
"""

from __future__ import annotations

from typing import Literal

from owtsweep.config import NotNegative, Positive, Section, key
from owtsweep.studies.base.searching import Searched


class Tuning(Section):
    """The section `filters`: what schemes assume, and their own numbers."""

    losses: Literal["as_printed", "known"] = key(
        "as_printed: reports of zeros are used as they are, but by KF, which multiplies R by 1e20 "
        "where all six are exactly zero; known: lost reports are left out"
    )
    process: Literal["declared", "truth"] = key(
        "where the noise of accelerations is from: the share below, or the sensors' own"
    )
    process_share: Positive = key(
        "declared noise of accelerations, as a part of their standard deviation"
    )
    bias: Literal["ignored", "truth"] = key(
        "what schemes with a bias state assume: a bias of the share below, or of the true size"
    )
    bias_share: NotNegative = key(
        "declared bias of accelerations, as a part of their standard deviation"
    )
    delay: Literal["ignored", "declared", "truth"] = key(
        "the delay that schemes which compensate it assume: none, the number below (then the "
        "printed predictors too predict by it), or the true one"
    )
    delay_declared: NotNegative = key("declared delay of the optical system", unit="s")
    attitude: Literal["level", "small", "reported"] = key(
        "with sensors fixed to the body: level: what they measure counts as that of the basin's "
        "frame; reported: it is turned by the last reported attitude, and gravity taken away; "
        "small: the same to first order of the angles"
    )
    angular_share: Positive = key(
        "with sensors fixed to the body: white noise that stands for angular accelerations, over "
        "their standard deviation"
    )
    lag: NotNegative = key("of the fixed-lag smoother", unit="s")
    start: Literal["report", "truth"] = key(
        "where the printed predictors begin: at the first report, or at the truth, as in the "
        "paper's tests with virtual data"
    )
    cutoff: Positive = key(
        "cut-off of the low-pass differentiator over the one that balances lag and noise"
    )
    crossover: Positive = key(
        "crossover of the complementary filter over the best one for the assumed noise and bias"
    )
    observer: Positive = key(
        "cut-off of the passive observer over the one that balances lag and noise"
    )


#: The schemes that are Kalman filters of the assumed noise of accelerations.
KALMAN = (
    "KF_STEADY", "KF", "KF_CONSISTENT", "KF_BIAS", "KF_DELAY", "KF_REPAIRED", "ERROR_STATE",
    "FIXED_LAG",
)  # fmt: skip
#: What `tune` searches.
SEARCHED = (
    Searched(("COMPLEMENTARY",), {"filters.crossover": [0.1, 10.0, "log"]}),
    Searched(("LOWPASS",), {"filters.cutoff": [0.1, 10.0, "log"]}),
    Searched(("PASSIVE_OBSERVER",), {"filters.observer": [0.1, 10.0, "log"]}),
    Searched(
        KALMAN,
        {"filters.process_share": [1e-3, 10.0, "log"]},
        lambda config: config.filters.process == "declared",
    ),
    Searched(
        KALMAN,
        {"filters.angular_share": [0.1, 30.0, "log"]},
        lambda config: config.sensors.frame == "body",
    ),
)
