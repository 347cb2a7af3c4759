"""Refuses settings of the scheme SWITCH that cannot work. Each message says what would work."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.errors import require
from owtsweep.studies.hub.names import LISTED
from owtsweep.studies.hub.switching.boundary import read_boundary

if TYPE_CHECKING:
    from owtsweep.studies.hub.scheme_sections import Switch


def check_switch(settings: Switch) -> None:
    """Raise `InputError` unless `switch` names two schemes and its boundary is a table."""
    others = ", ".join(name for name in LISTED if name != "SWITCH")
    for key, name in (("below", settings.below), ("above", settings.above)):
        require(
            name in LISTED,
            f"switch.{key}: there is no scheme {name!r}; use {others}",
        )
        require(
            name != "SWITCH",
            f"switch.{key}: SWITCH cannot switch to itself; name another scheme, e.g. HME1",
        )
    require(
        settings.below != settings.above,
        f"switch.above: {settings.above} is below the boundary too; name two different schemes",
    )
    if settings.boundary is not None:
        read_boundary(settings.boundary)
