"""Read a file into a checked recording in SI units."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.recorded.checks import check_channels, check_time
from owtsweep.motion.recorded.columns import ROLES, assign_roles
from owtsweep.motion.recorded.formats import open_table
from owtsweep.motion.recorded.formats.iso_times import ISO_TIME
from owtsweep.motion.recorded.formats.table import ChannelTable, refuse
from owtsweep.motion.recorded.recording import Recording
from owtsweep.motion.recorded.units import DIMENSIONS, find_factor

GAPS = ("refuse", "interpolate")


def read(
    path: str | Path,
    *,
    columns: Mapping[str, str | None] | None = None,
    units: Mapping[str, str | None] | None = None,
    gaps: str = "refuse",
) -> Recording:
    """Read and check one recorded file; return its contents by role, in SI units.

    Parameters
    ----------
    path
        The file. The extension decides the format; if several formats share the extension, the
        content decides.
    columns
        role -> channel, e.g. `{"position_x": "TwHt1TPxi"}`. A role says what a channel holds. Roles
        that are not given are guessed from well-known names; None or "" leaves a role out.
    units
        role -> unit, e.g. `{"position_x": "mm"}`, instead of the unit stated in the file. If no
        unit is given or stated, the SI unit is assumed, and a note says so.
    gaps
        What happens to long gaps (`checks.find_gaps`) in motion and specific force: "refuse" or
        "interpolate".

    Raises
    ------
    InputError
        If the file cannot be read or fails a check; the message names the file and what is wrong.
    """
    if gaps not in GAPS:
        raise InputError(f"gaps: {gaps!r} is none of {', '.join(GAPS)}")
    table = open_table(path)
    chosen = _assign_roles(table, columns or {})
    factors, notes = _find_factors(table, chosen, units or {})
    loaded = table.load(list(dict.fromkeys(chosen.values())), None)
    channels = {role: _scale_to_si(loaded, role, chosen, factors[role]) for role in chosen}
    del loaded
    time = channels.pop("time")
    check_time(table.path, chosen["time"], time)
    for values in channels.values():
        values[~np.isfinite(values)] = np.nan
    bare = Recording(table.path, time, channels, chosen, ())
    said = (*dict.fromkeys(table.notes), *notes, *check_channels(bare, gaps))
    return replace(bare, notes=said)


def _scale_to_si(
    loaded: Mapping[str, Array], role: str, chosen: Mapping[str, str], scale: float
) -> Array:
    """Return the values of a role in SI units.

    `loaded` maps channels to values, `chosen` maps roles to channels, and `scale` is the factor to
    SI units. The loaded array itself is changed, unless another role uses it too or it is
    read-only.
    """
    values = loaded[chosen[role]]
    shared = list(chosen.values()).count(chosen[role]) > 1  # one channel plays two roles
    if shared or not values.flags.writeable:
        values = values.copy()
    with np.errstate(over="ignore"):  # infinite values count as missing
        values *= scale
    return values


def _assign_roles(table: ChannelTable, columns: Mapping[str, str | None]) -> dict[str, str]:
    """Assign channels to roles: return role -> channel, with the role "time" first.

    A role says what a channel holds. `columns` maps roles to channels as the user says; other roles
    are guessed from well-known names (`columns.assign_roles`).

    Raises
    ------
    InputError
        If no channel has the role "time", or none has a role other than "time" and "yaw".
    """
    chosen = assign_roles(table, columns)
    listed = ", ".join(table.names[:12]) + (" ..." if len(table.names) > 12 else "")
    if "time" not in chosen:
        raise refuse(table.path, f"no time column found among {listed}: set columns.time=NAME")
    if len(chosen) == 1 or set(chosen) == {"time", "yaw"}:
        raise refuse(
            table.path,
            f"no channel with a known name among {listed}: set columns.position_x=NAME or "
            "columns.specific_force_x=NAME (--describe shows what is there)",
        )
    return {"time": chosen.pop("time"), **chosen}


def _find_factors(
    table: ChannelTable, chosen: Mapping[str, str], units: Mapping[str, str | None]
) -> tuple[dict[str, float], list[str]]:
    """Find the factor to SI of each role's unit; return role -> factor, and notes.

    `chosen` maps roles to channels, and `units` maps roles to units as the user says. A unit that
    the user does not give is the one stated in the file. If the file states none either, the factor
    is 1, and a note says so.

    Raises
    ------
    InputError
        If `units` names an unknown role, or a unit is not known or is not of the role's dimension.
    """
    for role in units:
        if role not in ROLES:
            raise InputError(f"units.{role}: no such role: use one of {', '.join(ROLES)}")
    factors, assumed = {}, []
    for role, name in chosen.items():
        given, stated = units.get(role), table.unit(name)
        if role == "time" and stated == ISO_TIME:
            if given:
                raise refuse(
                    table.path,
                    f"units.time={given}: the times ({name}) are dates with a time of day, which "
                    "become seconds; leave out units.time",
                )
            factors[role] = 1.0
        elif given:
            factors[role] = find_factor(given, ROLES[role], f"{table.path}: units.{role}")
        elif stated:
            where = f"{table.path}: channel {name} says its unit is"
            try:
                factors[role] = find_factor(stated, ROLES[role], where)
            except InputError as error:
                raise InputError(f"{error}; or give the unit by units.{role}") from None
        else:
            factors[role] = 1.0
            assumed.append(f"{role} in {DIMENSIONS[ROLES[role]][0]}")
    notes = [f"units not in the file, taken as SI: {', '.join(assumed)}"] if assumed else []
    unused = [f"units.{role}" for role, unit in units.items() if unit and role not in chosen]
    if unused:
        notes.append(f"without effect, no channel has this role: {', '.join(unused)}")
    return factors, notes
