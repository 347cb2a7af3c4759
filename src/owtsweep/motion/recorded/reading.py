"""Read a file into a checked recording in SI units."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.motion.recorded.checks import check_channels, check_time
from owtsweep.motion.recorded.choosing import Choice, begin_position, choose_channels
from owtsweep.motion.recorded.columns import (
    PARTS,
    ROLES,
    find_factors,
    list_names,
    refuse_without_time,
    to_si,
)
from owtsweep.motion.recorded.composing import Hub, compose, find_leans
from owtsweep.motion.recorded.formats import open_table
from owtsweep.motion.recorded.formats.table import ChannelTable
from owtsweep.motion.recorded.recording import Recording
from owtsweep.motion.recorded.units import DIMENSIONS

GAPS = ("refuse", "interpolate")


def read(
    path: str | Path,
    *,
    columns: Mapping[str, str | None] | None = None,
    units: Mapping[str, str | None] | None = None,
    gaps: str = "refuse",
    motion: str = "auto",
    tower_height: float | None = None,
    rotation: str = "zyx",
    rows: int | None = None,
) -> Recording:
    """Read and check one recorded file; return its contents by role, in SI units.

    If the file holds the hub's motion in parts, the position is composed from them (`compose`).

    path: the file.
    columns: role -> channel; other roles are guessed from well-known names, "" leaves one out.
    units: role -> unit, in place of the file's. Without any unit SI is assumed, and a note says so.
    gaps: what happens to gaps of more than 0.1 s and five steps in motion and specific force:
        "refuse" or "interpolate".
    motion: "auto" is the hub's, as far as the file holds it; "tower" the bending of the tower
        alone; "rigid" the platform with a stiff tower; "platform" the platform alone.
    tower_height: of the tower top above the platform's reference point, m; needed to compose.
    rotation: of the platform: "zyx" as in OpenFAST from 4.0 on, "small" as in FAST and before.
    rows: how many are read, from the first on; None: all.
    Raises InputError if the file cannot be read or fails a check.
    """
    require(gaps in GAPS, f"gaps: {gaps!r} is none of {', '.join(GAPS)}")
    table = open_table(path)
    hub = Hub(motion, tower_height, rotation)
    choice = choose_channels(table, columns or {}, hub)
    chosen, said = _require_motion(table, choice), choice.note
    factors = find_factors(table, chosen, ROLES, units or {}, "units.ROLE")
    notes = _note_units(chosen, factors, units or {})
    loaded = _load(table, chosen.values(), choice.angles.values(), rows)
    leans = find_leans(table, loaded, {**choice.angles, **chosen}, factors)
    channels = to_si(loaded, chosen, factors)
    del loaded
    time = channels.pop("time")
    check_time(table.path, chosen["time"], time)
    if any(role in PARTS for role in chosen):
        said = _compose(table.path, channels, chosen, hub)
    recording = Recording(table.path, time, channels, chosen, (), leans)
    more = [said] if said else []
    told = (*dict.fromkeys(table.notes), *notes, *more, *check_channels(recording, gaps))
    return replace(recording, notes=told)


def _require_motion(table: ChannelTable, choice: Choice) -> dict[str, str]:
    """Return role -> channel, time first."""
    if "time" not in choice.roles:
        raise refuse_without_time(table, "set columns.time=NAME")
    require(not choice.problem, f"{table.path}: {choice.problem}")
    require(
        bool(choice.roles.keys() - {"time", "yaw"}),
        f"{table.path}: no channel with a known name among {list_names(table)}: set "
        "columns.position_x=NAME or columns.specific_force_x=NAME (--describe shows what is there)",
    )
    return {"time": choice.roles["time"], **choice.roles}


def _load(
    table: ChannelTable, needed: Iterable[str], wished: Iterable[str], rows: int | None
) -> Mapping[str, Array]:
    names = list(dict.fromkeys(needed))
    more = [name for name in wished if name not in names]
    if more:
        with suppress(InputError):  # a file is not refused for a channel that nobody asked for
            return table.load([*names, *more], rows)
    return table.load(names, rows)


def _note_units(
    chosen: Mapping[str, str], factors: Mapping[str, float | None], units: Mapping[str, str | None]
) -> list[str]:
    for role in units:
        require(role in ROLES, f"units.{role}: no such role: use one of {', '.join(ROLES)}")
    assumed = [
        f"{role} in {DIMENSIONS[ROLES[role]][0]}" for role in chosen if factors[role] is None
    ]
    notes = [f"units not in the file, taken as SI: {', '.join(assumed)}"] if assumed else []
    unused = [f"units.{role}" for role, unit in units.items() if unit and role not in chosen]
    if unused:
        notes.append(f"without effect, no channel has this role: {', '.join(unused)}")
    return notes


def _compose(path: Path, channels: dict[str, Array], chosen: dict[str, str], hub: Hub) -> str:
    values = {role: channels.pop(role) for role in PARTS if role in channels}
    names = {role: chosen.pop(role) for role in PARTS if role in chosen}
    composed, sources, note = compose(path, values, names, hub)
    use = begin_position(chosen)
    channels |= {use + axis: moved for axis, moved in composed.items()}
    chosen |= {use + axis: source for axis, source in sources.items()}
    return note
