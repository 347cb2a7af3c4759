"""Compose the horizontal motion of the hub from the motion of a platform and the tower's bending.

The tower top lies at (b_x, b_y, h + b_z) in the frame of the tower base, which turns with the
platform: h is its height above the platform's reference point at rest, and b the displacement by
bending. So its horizontal displacement is

    x = surge + [R (b_x, b_y, h + b_z)]_x,    y = sway + [R (b_x, b_y, h + b_z)]_y,
    R = R_z(yaw) R_y(pitch) R_x(roll),

so for small angles x = surge + h sin(pitch) + b_x and y = sway - h sin(roll) + b_y. The axes are
those of FAST: x downwind, y to the left when looking downwind, z up. R is the transpose of
EulerConstructZYX in OpenFAST (modules/nwtc-library/src/NWTC_Num.f90), by which ElastoDyn turns the
platform since version 4.0. FAST and OpenFAST before that turned it by SmllRotTrans of that file:
by the orthonormal matrix nearest to that of small angles, which differs from R in second order.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.recorded.columns import PARTS
from owtsweep.motion.recorded.formats.table import refuse
from owtsweep.motion.recorded.parts import TRANSLATION

#: A platform whose channels vary by less than this does not move: 1 mm, and 1 mm at 100 m.
LEAST = {"length": 1e-3, "angle": 1e-5}
#: The rotation that moves the tower top along each axis.
TILT = {"x": "platform_pitch", "y": "platform_roll"}
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

Composed = tuple[dict[str, Array], dict[str, str], str]


def compose(
    path: Path,
    values: Mapping[str, Array],
    names: Mapping[str, str],
    *,
    tower_height: float | None,
    rigid: bool = False,
) -> Composed:
    """Compose the motion of the hub along x and y from its parts.

    Along an axis of which the file has no part, there is no result.

    Parameters
    ----------
    path
        The file, for messages.
    values
        Role of a part (`columns.PARTS`) -> values in m or rad, shape (n,); NaN where missing.
    names
        Role of a part -> the channel's name.
    tower_height
        Height of the tower top above the platform's reference point, m; None if unknown.
    rigid
        Whether the tower does not bend.

    Returns
    -------
    tuple
        axis "x" or "y" -> displacement of the hub in m, shape (n,); axis -> the names of the
        channels that it is composed from; and a note for the user, which states the formula.

    Raises
    ------
    InputError
        If the platform moves and a part or the height is missing, or nothing moves that could be
        composed.
    """
    platform = [role for role in values if role.startswith("platform")]
    moving = [role for role in platform if _extent(values[role]) > LEAST[PARTS[role]]]
    bends = {axis: f"tower_{axis}" for axis in "xy" if f"tower_{axis}" in values}
    if not moving and bends and not rigid:
        channels = {axis: values[role] for axis, role in bends.items()}
        listed = " and ".join(names[role] for role in bends.values())
        still = f"the platform does not move ({', '.join(names[role] for role in platform)})"
        note = f"{listed}: the displacement of the tower top from its base; {still}"
        return channels, {axis: names[role] for axis, role in bends.items()}, note
    axes = _find_axes(path, names, rigid=rigid)
    if tower_height is None:
        raise refuse(
            path,
            f"the platform moves ({', '.join(names[role] for role in moving or platform)}): give "
            "the height of the tower top above the platform's reference point (in FAST: TowerHt - "
            "PtfmRefzt), e.g. columns.tower_height=87.6"
            + ("" if rigid else ", or take the tower's bending alone by columns.motion=tower"),
        )
    channels = {axis: _add_up(values, axis, tower_height) for axis in axes}
    sources = {
        axis: " + ".join(
            names[role]
            for role in (TRANSLATION[axis], TILT[axis], f"tower_{axis}")
            if role in names
        )
        for axis in axes
    }
    return channels, sources, _state_formula(values, names, channels, tower_height)


def _find_axes(path: Path, names: Mapping[str, str], *, rigid: bool) -> list[str]:
    """Return the axes along which the motion can be composed; refuse an axis with some parts only.

    `names` maps the roles of parts to channels.
    """
    missing: dict[str, list[str]] = {}
    for axis in "xy":
        needed = [TRANSLATION[axis], TILT[axis]] + ([] if rigid else [f"tower_{axis}"])
        own = [role for role in needed if role != TILT[axis]]  # tilt alone says nothing of an axis
        missing[axis] = [role for role in needed if role not in names]
        if missing[axis] and not any(role in names for role in own):
            del missing[axis]
    lacking = [role for roles in missing.values() for role in roles]
    if lacking or not missing:
        wanted = lacking or ["platform_surge", "platform_pitch", "tower_x"]
        listed = ", ".join(f"{role} ({EXAMPLES[role]})" for role in wanted)
        other = "columns.motion=tower for the tower's bending alone"
        if not any(role.startswith("tower") for role in names):
            other = "columns.motion=rigid for a stiff tower, columns.motion=platform for no tower"
        have = ", ".join(names.values())
        raise refuse(
            path,
            f"the motion of the hub cannot be composed from {have}: missing {listed}; name what is "
            f"missing by columns.ROLE=NAME, or take {other}",
        )
    return list(missing)


def _add_up(values: Mapping[str, Array], axis: str, height: float) -> Array:
    """Return surge + [R (b_x, b_y, height + b_z)]_x, or for "y" sway and the y component; m.

    `values` maps the roles of parts to arrays of shape (n,); a part that is not there is 0.
    """
    result = values[TRANSLATION[axis]].copy()
    for begin in range(0, len(result), ROWS):
        rows = slice(begin, begin + ROWS)
        part = {role: values[role][rows] if role in values else 0.0 for role in PARTS}
        roll, pitch, yaw = (part[f"platform_{name}"] for name in ("roll", "pitch", "yaw"))
        # Turn about x by the roll, about y by the pitch, about z by the yaw.
        up = height + part["tower_z"]
        y = np.cos(roll) * part["tower_y"] - np.sin(roll) * up
        z = np.sin(roll) * part["tower_y"] + np.cos(roll) * up
        x = np.cos(pitch) * part["tower_x"] + np.sin(pitch) * z
        turned = {"x": np.cos(yaw) * x - np.sin(yaw) * y, "y": np.sin(yaw) * x + np.cos(yaw) * y}
        result[rows] += turned[axis]
    return result


def _state_formula(
    values: Mapping[str, Array],
    names: Mapping[str, str],
    channels: Mapping[str, Array],
    height: float,
) -> str:
    """State in one sentence how the motion was composed, and how much each part moves the hub."""
    bending = ", ".join(names.get(f"tower_{axis}", "0") for axis in "xy")
    up = f"{height:g} m" + (f" + {names['tower_z']}" if "tower_z" in names else "")
    turns = " ".join(
        f"R{axis}({names[role]})"
        for axis, role in zip(
            "zyx", ("platform_yaw", "platform_pitch", "platform_roll"), strict=True
        )
        if role in names
    )
    sums = ", ".join(f"{axis} = {names[TRANSLATION[axis]]} + [R b]_{axis}" for axis in channels)
    sizes = []
    for axis in channels:
        tilt = height * np.sin(values[TILT[axis]])
        parts = {"platform": values[TRANSLATION[axis]], "tilt": tilt}
        if f"tower_{axis}" in values:
            parts["bending"] = values[f"tower_{axis}"]
        stated = ", ".join(f"{name} {np.nanstd(part):.3g}" for name, part in parts.items())
        sizes.append(f"along {axis} {stated}, sum {np.nanstd(channels[axis]):.3g} m")
    return (
        f"motion of the hub composed: {sums}, with b = ({bending}, {up}) and R = {turns}; standard "
        f"deviations {'; '.join(sizes)}"
    )


def _extent(values: Array) -> float:
    """Return the range of the finite values; 0 if there are none."""
    there = values[np.isfinite(values)]
    return float(np.ptp(there)) if len(there) else 0.0
