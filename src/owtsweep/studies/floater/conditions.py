"""The conditions of the floater study: axes that its grid may have, of which a map shows two."""

from __future__ import annotations

from owtsweep.results.conditions import Condition

#: All axes, in the order of `sections.AXES`.
CONDITIONS = (
    Condition("delay", "delay of the optical system", "samples", plural="delays"),
    Condition("bias", "bias of accelerometers over standard deviation", plural="biases"),
    Condition("snr", "signal-to-noise ratio", "dB"),
    Condition("loss", "share of reports lost", plural="shares of reports lost"),
    Condition("believed", "believed over true variance of noise", scale="log"),
    Condition("roll", "standard deviation of roll", "deg", scale="log"),
)
