"""The conditions of the blade study: axes that its grid may have, of which a map shows two."""

from __future__ import annotations

from owtsweep.results.conditions import Condition

#: All axes, in the order of `sections.AXES`.
CONDITIONS = (
    Condition("sigma", "standard deviation of a GNSS fix", "m", scale="log", enters="sensors"),
    Condition("outage", "length of an outage of GNSS", "s", enters="sensors"),
    Condition("offset", "by what GNSS time stamps come late", "s", enters="sensors"),
    Condition("period", "natural period of the swing", "s"),
    Condition("amplitude", "standard deviation of the swing", "m", scale="log"),
    Condition("lever", "error of the antenna's place", "m", enters="sensors"),
    Condition("heading", "standard deviation of the heading", "deg", scale="log"),
)
