"""The conditions of the floater study: axes that its grid may have, of which a map shows two."""

from __future__ import annotations

from owtsweep.results.conditions import Condition

#: All axes, in the order of `sections.AXES`.
CONDITIONS = (
    Condition("delay", "delay of the optical system", "samples", plural="delays", enters="sensors"),
    Condition(
        "bias", "bias of accelerometers over standard deviation", plural="biases", enters="sensors"
    ),
    Condition("snr", "signal-to-noise ratio", "dB", enters="sensors"),
    Condition("loss", "share of reports lost", plural="shares of reports lost", enters="sensors"),
    Condition("believed", "believed over true variance of noise", scale="log", enters="knowledge"),
    Condition("roll", "standard deviation of roll", "deg", scale="log"),
)
