"""Compose the horizontal motion of the hub from the motion of a platform and the tower's bending.

The tower top lies at (b_x, b_y, h + b_z) in the frame of the tower base, which turns with the
platform: h is its height above the platform's reference point at rest, and b the displacement by
bending. So its horizontal displacement is

    x = surge + [R (b_x, b_y, h + b_z)]_x,    y = sway + [R (b_x, b_y, h + b_z)]_y,
    R = R_z(yaw) R_y(pitch) R_x(roll).

This R is ElastoDyn's (EulerConstructZYX in OpenFAST's modules/nwtc-library/src/NWTC_Num.f90) since
OpenFAST 4.0. Before, it was the orthonormal matrix nearest to I + [a]x, a = (roll, pitch, yaw)
(SmllRotTrans in the same file): a turn about a by arctan |a|. docs/recorded.md has axes and names.
"""

from __future__ import annotations

from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import Literal, NamedTuple, get_args

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
from owtsweep.motion.recorded.columns import PARTS, ROLES, find_factors
from owtsweep.motion.recorded.formats.table import ChannelTable

#: Axis -> the platform's translation along it, the rotation by which a body leans along it, and the
#: tower's bending.
ALONG = {
    "x": ("platform_surge", "platform_pitch", "tower_x"),
    "y": ("platform_sway", "platform_roll", "tower_y"),
}
#: A platform whose channels vary by less than this does not move: 1 mm, and 1 mm at 100 m.
LEAST = {"length": 1e-3, "angle": 1e-5}
#: Names in FAST of the parts that are needed.
EXAMPLES = {
    "platform_surge": "PtfmSurge",
    "platform_sway": "PtfmSway",
    "platform_roll": "PtfmRoll",
    "platform_pitch": "PtfmPitch",
    "tower_x": "TTDspFA or YawBrTDxt",
    "tower_y": "TTDspSS or YawBrTDyt",
}
#: Rows composed at once, to save memory.
ROWS = 1 << 18

#: How the platform's angles are to be read: turns about z, y and x, as in OpenFAST from 4.0 on; or
#: the small angles of FAST and of OpenFAST before.
Rotation = Literal["zyx", "small"]
Vector = tuple[Array, ...]


class Hub(NamedTuple):
    """Which motion of the hub is wanted, as in `reading.read`."""

    motion: str  # of `choosing.MotionKind`
    tower_height: float | None  # m
    rotation: str  # of `Rotation`


def find_leans(
    table: ChannelTable,
    loaded: Mapping[str, Array],
    names: Mapping[str, str],
    factors: Mapping[str, float | None],
) -> dict[str, tuple[str, Array | None]]:
    """Find the angles that lean a platform: axis -> channel and angle, as `Recording.leans`.

    loaded: channel -> values in the file's units, (n,). names, factors: role -> channel, and the
        factor to SI of its unit.
    """
    leans: dict[str, tuple[str, Array | None]] = {}
    for axis, (_, role, _) in ALONG.items():
        name = names.get(role)
        if name is None or name not in loaded or find_extent(loaded[name]) == 0.0:
            continue
        factor = factors.get(role)
        if factor is None:
            with suppress(InputError):  # of another unit it is not known what the channel holds
                factor = find_factors(table, {role: name}, ROLES, {}, "units.ROLE")[role]
        leans[axis] = (name, None if factor is None else factor * loaded[name])
    return leans


def compose(
    path: Path,
    values: Mapping[str, Array],
    names: Mapping[str, str],
    hub: Hub,
) -> tuple[dict[str, Array], dict[str, str], str]:
    """Compose the motion of the hub along x and y from its parts.

    values, names: role of a part -> values in m or rad, (n,), NaN where missing, and the channel's
        name. Returns: axis -> displacement of the hub in m, (n,), for axes that have parts; axis ->
        the names of its channels; and a note for the user, which states the formula.
    Raises InputError if the rotation is unknown, the platform moves and a part or the height is
        missing, or the parts make no motion.
    """
    rotation, rigid = hub.rotation, hub.motion == "rigid"
    require(
        rotation in get_args(Rotation),
        f"columns.rotation: {rotation!r} is none of {', '.join(get_args(Rotation))}",
    )
    platform = [role for role in values if role.startswith("platform")]
    moving = [role for role in platform if find_extent(values[role]) > LEAST[PARTS[role]]]
    bends = {axis: role for axis, (_, _, role) in ALONG.items() if role in values}
    if not moving and bends and not rigid:
        sources = {axis: names[role] for axis, role in bends.items()}
        still = f"the platform does not move ({', '.join(names[role] for role in platform)})"
        listed = " and ".join(sources.values())
        note = f"{listed}: the displacement of the tower top from its base; {still}"
        return {axis: values[role] for axis, role in bends.items()}, sources, note
    axes = _find_axes(path, names, rigid=rigid)
    if hub.tower_height is None:
        other = "" if rigid else ", or take the tower's bending alone by columns.motion=tower"
        listed = ", ".join(names[role] for role in moving or platform)
        raise InputError(
            f"{path}: the platform moves ({listed}): give the height of the tower top above the "
            "platform's reference point (in FAST: TowerHt - PtfmRefzt), e.g. "
            f"columns.tower_height=87.6{other}"
        )
    channels = {axis: _add_up(values, axis, hub.tower_height, rotation) for axis in axes}
    sources = {
        axis: " + ".join(names[role] for role in ALONG[axis] if role in names) for axis in axes
    }
    note = _state_formula(values, names, channels, hub.tower_height, rotation)
    return channels, sources, note


def _find_axes(path: Path, names: Mapping[str, str], *, rigid: bool) -> list[str]:
    missing: dict[str, list[str]] = {}
    for axis, roles in ALONG.items():
        if roles[0] in names or roles[2] in names:  # tilt alone says nothing of an axis
            needed = roles[:2] if rigid else roles
            missing[axis] = [role for role in needed if role not in names]
    lacking = [role for roles in missing.values() for role in roles]
    if lacking or not missing:
        wanted = lacking or ["platform_surge", "platform_pitch", "tower_x"]
        listed = ", ".join(f"{role} ({EXAMPLES[role]})" for role in wanted)
        other = "columns.motion=tower for the tower's bending alone"
        if not any(role.startswith("tower") for role in names):
            other = "columns.motion=rigid for a stiff tower, columns.motion=platform for no tower"
        have = ", ".join(names.values())
        raise InputError(
            f"{path}: the motion of the hub cannot be composed from {have}: missing {listed}; name "
            f"what is missing by columns.ROLE=NAME, or take {other}"
        )
    return list(missing)


def _add_up(values: Mapping[str, Array], axis: str, height: float, rotation: str) -> Array:
    turn = _turn_about_axes if rotation == "zyx" else _turn_by_small_angles
    result = values[ALONG[axis][0]].copy()
    for begin in range(0, len(result), ROWS):
        rows = slice(begin, begin + ROWS)
        part = {role: values[role][rows] if role in values else np.zeros(1) for role in PARTS}
        angles = tuple(part[f"platform_{name}"] for name in ("roll", "pitch", "yaw"))
        top = (part["tower_x"], part["tower_y"], height + part["tower_z"])
        result[rows] += turn(angles, top)["xy".index(axis)]
    return result


def _turn_about_axes(angles: Vector, v: Vector) -> tuple[Array, Array]:
    roll, pitch, yaw = angles
    y, z = np.cos(roll) * v[1] - np.sin(roll) * v[2], np.sin(roll) * v[1] + np.cos(roll) * v[2]
    x = np.cos(pitch) * v[0] + np.sin(pitch) * z
    return np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y


def _turn_by_small_angles(angles: Vector, v: Vector) -> tuple[Array, Array]:
    """Turn v about the axis a = `angles` by arctan |a|: return x and y."""
    a = angles
    s = np.sqrt(1.0 + a[0] ** 2 + a[1] ** 2 + a[2] ** 2)
    along = (a[0] * v[0] + a[1] * v[1] + a[2] * v[2]) / (s + 1.0)
    return (
        (v[0] + a[1] * v[2] - a[2] * v[1] + a[0] * along) / s,
        (v[1] + a[2] * v[0] - a[0] * v[2] + a[1] * along) / s,
    )


def _state_formula(
    values: Mapping[str, Array],
    names: Mapping[str, str],
    channels: Mapping[str, Array],
    height: float,
    rotation: str,
) -> str:
    turns = {"z": "platform_yaw", "y": "platform_pitch", "x": "platform_roll"}
    known = {axis: names[role] for axis, role in turns.items() if role in names}
    matrix = f"the small-angle rotation of {', '.join(known.values())}"
    if rotation == "zyx":
        matrix = " ".join(f"R{axis}({name})" for axis, name in known.items())
    bending = ", ".join(names.get(f"tower_{axis}", "0") for axis in "xy")
    up = f"{height:g} m" + (f" + {names['tower_z']}" if "tower_z" in names else "")
    sums, sizes = [], []
    for axis, channel in channels.items():
        translation, tilt, bend = ALONG[axis]
        sums.append(f"{axis} = {names[translation]} + [R b]_{axis}")
        parts = {"platform": values[translation], "tilt": height * np.sin(values[tilt])}
        if bend in values:
            parts["bending"] = values[bend]
        stated = ", ".join(f"{name} {np.nanstd(part):.3g}" for name, part in parts.items())
        sizes.append(f"along {axis} {stated}, sum {np.nanstd(channel):.3g} m")
    return (
        f"motion of the hub composed: {', '.join(sums)}, with b = ({bending}, {up}) and R = "
        f"{matrix}; standard deviations {'; '.join(sizes)}"
    )


def find_extent(values: Array) -> float:
    """Return the range of the finite values, shape (n,); 0 if there are none."""
    there = values[np.isfinite(values)]
    with np.errstate(over="ignore"):  # some hold 1e308, as a sign that a value is missing
        return float(np.ptp(there)) if len(there) else 0.0
