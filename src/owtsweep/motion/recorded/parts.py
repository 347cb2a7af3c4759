"""Know the parts of the hub's motion that FAST and OpenFAST write to channels of their own.

A floating turbine's hub moves with the platform (surge, sway and tilt) and by the bending of the
tower; `composing` adds these parts up. What the channels mean is in OpenFAST's source
(modules/elastodyn/src/ElastoDyn.f90, AllOuts): PtfmSurge is that of the platform's reference point
in the inertial frame; YawBrTDxt (TTDspFA is another name of it) is relative to the tower base,
which moves with the platform.
"""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence

from owtsweep.motion.recorded.columns import PARTS, strip

#: role -> pattern of the channels' names; case and all but letters and digits are ignored.
PATTERNS = {
    "platform_surge": "ptfmsurge|ptfmtdxi|platformsurge|qsg",
    "platform_sway": "ptfmsway|ptfmtdyi|platformsway|qsw",
    "platform_roll": "ptfmroll|ptfmrdxi|platformroll|qr",
    "platform_pitch": "ptfmpitch|ptfmrdyi|platformpitch|qp",
    "platform_yaw": "ptfmyaw|ptfmrdzi|platformyaw|qy",
    "tower_x": "yawbrtdxt|ttdspfa|yawbrtdxp|towerx|towertopx",
    "tower_y": "yawbrtdyt|ttdspss|yawbrtdyp|towery|towertopy",
    "tower_z": "yawbrtdzt|ttdspax|yawbrtdzp",
}
#: Further names of the platform's angles beside a position. HAWC2: projected angles of a body,
#: about the global axes, of which the first body is taken.
ANGLES = {
    "platform_roll": PATTERNS["platform_roll"] + r"|(staterot)?projangt?x.*global\d*",
    "platform_pitch": PATTERNS["platform_pitch"] + r"|(staterot)?projangt?y.*global\d*",
}
#: The rotation by which a body leans along each axis.
TILT = {"x": "platform_pitch", "y": "platform_roll"}
#: The translation of the platform's reference point along each axis.
TRANSLATION = {"x": "platform_surge", "y": "platform_sway"}


def find_parts(
    names: Sequence[str], chosen: Mapping[str, str], left_out: Sequence[str]
) -> dict[str, str]:
    """Find the channels of the parts of the motion: return role -> channel.

    `names` are all channels of the file. Channels in `chosen` (role -> channel) are taken, roles in
    `left_out` are not, and the other roles are guessed by `PATTERNS`.
    """
    found = {role: chosen.get(role) or find(names, PATTERNS[role]) for role in PARTS}
    return {role: name for role, name in found.items() if name and role not in left_out}


def find_angles(
    names: Sequence[str], chosen: Mapping[str, str], left_out: Sequence[str]
) -> dict[str, str]:
    """Find the channels of the platform's roll and pitch: return role -> channel.

    Arguments as for `find_parts`. The bare names roll and pitch are taken as a pair only, because
    a pitch alone may be that of the blades.
    """
    found = {role: chosen.get(role) or find(names, ANGLES[role]) for role in TILT.values()}
    bare = {role: find(names, role.removeprefix("platform_")) for role in found}
    if all(bare.values()) and not any(found.values()):
        found = bare
    return {role: name for role, name in found.items() if name and role not in left_out}


def keep_axes(parts: Mapping[str, str], axes: Sequence[str]) -> dict[str, str]:
    """Return the parts (role -> channel) without the translations of axes not in `axes`."""
    others = [axis for axis in "xy" if axis not in axes]
    unused = [role for axis in others for role in (TRANSLATION[axis], f"tower_{axis}")]
    return {role: name for role, name in parts.items() if role not in unused}


def imply_unit(role: str, name: str) -> str:
    """Return the unit that FAST always uses for a channel, e.g. "deg" for PtfmPitch; "" if unknown.

    `role` is the part of the motion that the channel `name` is taken for.
    """
    return "deg" if PARTS.get(role) == "angle" and strip(name).startswith("ptfm") else ""


def find(names: Sequence[str], pattern: str) -> str | None:
    """Return the first channel that matches the alternatives of a pattern, earlier ones first."""
    for part in pattern.split("|"):
        for name in names:
            if re.fullmatch(part, strip(name)):
                return name
    return None


def find_all(names: Sequence[str], pattern: str) -> list[str]:
    """Return the channels whose names match a pattern, in the order of their names."""
    return sorted(name for name in names if re.fullmatch(pattern, strip(name)))
