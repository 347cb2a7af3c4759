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
    """Read and check one recording.

    Parameters
    ----------
    path
        The file. The extension decides the format; if several formats share the extension, the
        content decides.
    columns
        role -> channel, e.g. `{"position_x": "TwHt1TPxi"}`. Roles that are not given are guessed
        from well-known names; None or "" leaves a role out.
    units
        role -> unit, e.g. `{"position_x": "mm"}`, instead of the unit stated in the file. If no
        unit is given or stated, the SI unit is assumed, and a note says so.
    gaps
        What happens to long gaps (`checks.find_gaps`) in motion and specific force: "refuse" or
        "interpolate".

    Raises
    ------
    InputError
        If the file cannot be read or fails a check; the message names the file and the place.
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
    return replace(bare, notes=(*notes, *check_channels(bare, gaps)))


def _scale_to_si(
    loaded: Mapping[str, Array], role: str, chosen: Mapping[str, str], scale: float
) -> Array:
    """Return a role's values in SI units; the loaded array is changed if no other role uses it."""
    values = loaded[chosen[role]]
    shared = list(chosen.values()).count(chosen[role]) > 1  # one channel plays two roles
    if shared or not values.flags.writeable:
        values = values.copy()
    with np.errstate(over="ignore"):  # infinite values count as missing
        values *= scale
    return values


def _assign_roles(table: ChannelTable, columns: Mapping[str, str | None]) -> dict[str, str]:
    """Assign channels to roles as `columns.assign_roles` does: return role -> channel, time first.

    Raises
    ------
    InputError
        If there is no time, or no other channel with a role besides yaw.
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

    The unit is the one in `units`, else the one stated in the file. If there is neither, the factor
    is 1, and a note says so.
    """
    for role in units:
        if role not in ROLES:
            raise InputError(f"units.{role}: no such role: use one of {', '.join(ROLES)}")
    factors, assumed = {}, []
    for role, name in chosen.items():
        given, stated = units.get(role), table.unit(name)
        if given:
            factors[role] = find_factor(given, ROLES[role], f"{table.path}: units.{role}")
        elif stated:
            where = f"{table.path}: channel {name} says its unit is"
            try:
                factors[role] = find_factor(stated, ROLES[role], where)
            except InputError as error:
                raise InputError(f"{error}; or give it by units.{role}") from None
        else:
            factors[role] = 1.0
            assumed.append(f"{role} in {DIMENSIONS[ROLES[role]][0]}")
    notes = [f"units not in the file, taken as SI: {', '.join(assumed)}"] if assumed else []
    return factors, notes
