"""The conditions of the mating study: axes that its grid may have, of which a map shows two."""

from __future__ import annotations

from owtsweep.results.conditions import Condition

CONDITIONS = (
    Condition("sigma", "standard deviation of a fix on the blade", "m", scale="log"),
    Condition("outage", "length of an outage on the blade", "s"),
    Condition("hub_sigma", "standard deviation of a fix on the hub", "m", scale="log"),
    Condition("hold", "time together", "s"),
)
AXES = tuple(condition.name for condition in CONDITIONS)
