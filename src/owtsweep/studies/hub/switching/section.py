"""The section `switch` of the configuration."""

from __future__ import annotations

from owtsweep.config import NotNegative, Positive, Section, key


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
