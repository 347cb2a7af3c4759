"""Choose the channels that give the motion of the hub: whole positions, or parts of the motion.

Whole are positions in the inertial frame: what the user names, OpenFAST's TwrTpTDxi of the tower
top, TwHt1TPxi of a gauge on the tower, HAWC2's states in global coordinates.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from typing import Literal, NamedTuple, get_args

from owtsweep.errors import InputError, require
from owtsweep.motion.recorded.columns import PARTS, assign_roles, find, find_all, strip
from owtsweep.motion.recorded.composing import ALONG, Hub
from owtsweep.motion.recorded.formats.table import ChannelTable

#: Which motion a user may ask for: the hub's, as far as the file holds it; the bending of the tower
#: alone; the platform with a stiff tower on it; the platform's reference point.
MotionKind = Literal["auto", "tower", "rigid", "platform"]
WHOLE = {"x": "twrtptdxi", "y": "twrtptdyi"}
GAUGES = {"x": r"twht\dtpxi", "y": r"twht\dtpyi"}
#: role -> patterns of the channels' names; case and all but letters and digits are ignored.
PATTERNS = {
    "platform_surge": ("ptfmsurge", "ptfmtdxi", "platformsurge", "qsg"),
    "platform_sway": ("ptfmsway", "ptfmtdyi", "platformsway", "qsw"),
    "platform_roll": ("ptfmroll", "ptfmrdxi", "platformroll", "qr"),
    "platform_pitch": ("ptfmpitch", "ptfmrdyi", "platformpitch", "qp"),
    "platform_yaw": ("ptfmyaw", "ptfmrdzi", "platformyaw", "qy"),
    "tower_x": ("yawbrtdxt", "ttdspfa", "yawbrtdxp", "towerx", "towertopx"),
    "tower_y": ("yawbrtdyt", "ttdspss", "yawbrtdyp", "towery", "towertopy"),
    "tower_z": ("yawbrtdzt", "ttdspax", "yawbrtdzp"),
}
#: Further names of the platform's angles beside a position: HAWC2's projected angles of a body,
#: about the global axes, of which the first body is taken.
ANGLES = {
    "platform_roll": r"(staterot)?projangt?x.*global\d*",
    "platform_pitch": r"(staterot)?projangt?y.*global\d*",
}


class Choice(NamedTuple):
    """The channels chosen from a file, those for the motion of the hub among them."""

    #: role -> channel: of position_x, ... (reference_x, ... beside a specific force) or of `PARTS`,
    #: and of all other roles.
    roles: dict[str, str]
    problem: str = ""  # why they do not give the motion, and what would work
    note: str = ""  # what the user should know about them
    angles: Mapping[str, str] = {}  # role -> channel of angles that lean a platform


def choose_channels(table: ChannelTable, given: Mapping[str, str | None], hub: Hub) -> Choice:
    """Choose the channels of a file by their names.

    given: role -> channel, as the user says; it goes before the names. None or "" leaves one out.
    Raises InputError as `columns.assign_roles`, or if `hub.motion` is unknown, or the user gives
    both a position and parts of it.
    """
    kinds = get_args(MotionKind)
    require(hub.motion in kinds, f"columns.motion: {hub.motion!r} is none of {', '.join(kinds)}")
    told = {role: "" if name is None else str(name).strip() for role, name in given.items()}
    chosen = assign_roles(table, told)
    choice = _choose_motion(table.names, chosen, told, hub)
    use = begin_position(chosen)
    replaced = [*PARTS, f"{use}x", f"{use}y"] if choice.roles else [*PARTS]
    kept = {role: name for role, name in chosen.items() if role not in replaced}
    roles = {**kept, **choice.roles}
    felt = "specific_force_x" in roles  # which holds the lean already
    return choice._replace(roles=roles, angles={} if felt else _find_angles(table, roles, told))


def _find_angles(
    table: ChannelTable, roles: Mapping[str, str], told: Mapping[str, str]
) -> dict[str, str]:
    """Find the channels of the platform's roll and pitch.

    The bare names are taken as a pair only, because a pitch alone may be that of the blades.
    """
    found = {
        role: roles.get(role) or find(table.names, *PATTERNS[role], pattern)
        for role, pattern in ANGLES.items()
    }
    bare = {role: find(table.names, role.removeprefix("platform_")) for role in found}
    if all(bare.values()) and not any(found.values()):
        found = bare
    return {role: name for role, name in found.items() if name and told.get(role) != ""}


def _choose_motion(
    names: Sequence[str], chosen: Mapping[str, str], told: Mapping[str, str], hub: Hub
) -> Choice:
    motion, height = hub.motion, hub.tower_height
    by_user = {role for role, name in told.items() if name}
    out = told.keys() - by_user
    use = begin_position(chosen)
    axes = [axis for axis in "xy" if not {f"position_{axis}", use + axis} & out]
    unused = {role for axis in "xy" if axis not in axes for role in ALONG[axis][::2]} | out
    found = {role: chosen.get(role) or find(names, *PATTERNS[role]) for role in PARTS}
    parts = {role: name for role, name in found.items() if name and role not in unused}
    positions = [role for role in chosen if role.startswith(("position_", "reference_"))]
    if motion != "auto" or by_user.intersection(PARTS):
        if clash := sorted(by_user.intersection(positions)):
            what = f"columns.motion={motion}" if motion != "auto" else "parts of a motion"
            raise InputError(f"columns.{clash[0]}: it and {what} are given; give one of them")
        return _choose_as_told(parts, use, motion)
    if positions:
        return Choice({}, note=_note_on_position(names, chosen, parts))
    if use == "reference_" and len(axes) < 2:
        return Choice({})
    choice = _choose_by_names(names, parts, axes, use, height)
    unsaid = height is None and any(role in PARTS for role in choice.roles)
    if use == "reference_" and (unsaid or choice.problem):  # sensors can do without a reference
        return Choice(
            {},
            note="no reference: platform and tower are composed to one only if "
            "columns.tower_height is given; columns.reference_x=NAME takes a channel",
        )
    return choice


def _choose_as_told(parts: dict[str, str], use: str, motion: str) -> Choice:
    if motion == "auto":
        return Choice(parts)
    if motion == "rigid":
        return Choice({role: name for role, name in parts.items() if role.startswith("platform")})
    place = 0 if motion == "platform" else 2
    roles = {use + axis: parts[role[place]] for axis, role in ALONG.items() if role[place] in parts}
    if not roles:
        wanted = "PtfmSurge" if motion == "platform" else "YawBrTDxt or TTDspFA"
        return Choice({}, problem=f"columns.motion={motion}: no channel such as {wanted}")
    if motion == "platform":
        listed = " and ".join(roles.values())
        note = f"{listed}: the motion of the platform's reference point, not of the hub"
    else:
        note = _note_on_bending(roles.values())
    return Choice(roles, note=f"{note} (columns.motion={motion})")


def _choose_by_names(
    names: Sequence[str],
    parts: dict[str, str],
    axes: Sequence[str],
    use: str,
    tower_height: float | None,
) -> Choice:
    whole = {axis: name for axis, pattern in WHOLE.items() if (name := find(names, pattern))}
    gauges = {axis: sorted(find_all(names, pattern)) for axis, pattern in GAUGES.items()}
    bending = {axis: parts[f"tower_{axis}"] for axis in "xy" if f"tower_{axis}" in parts}
    floats = any(role.startswith("platform") and role != "platform_yaw" for role in parts)
    alone = max(len(found) for found in gauges.values()) == 1
    if whole:
        taken, note = whole, ""
    elif alone and not (bending and floats and tower_height):
        taken = {axis: found[0] for axis, found in gauges.items() if found}
        note = (
            f"{' and '.join(taken.values())}: a gauge at a height on the tower that the file does "
            "not hold; if this is below the top, the hub moves more"
        )
        if bending and floats:
            note += (
                "; columns.tower_height composes the motion of the top from platform and bending"
            )
    elif floats and (bending or not any(gauges.values())):
        return Choice(parts)
    elif any(gauges.values()):
        found = gauges["x"] or gauges["y"]
        problem = (
            f"{', '.join(found)} are gauges on the tower at heights that the file does not hold: "
            f"name the highest, e.g. columns.position_x={found[-1]}"
        )
        if "x" in bending:
            problem += f", or take {bending['x']} by columns.motion=tower if the base is fixed"
        return Choice({}, problem=problem)
    else:
        taken, note = bending, _note_on_bending(bending.values()) if bending else ""
    return Choice({use + axis: taken[axis] for axis in axes if axis in taken}, note=note)


def begin_position(chosen: Mapping[str, str]) -> str:
    """Return how the role of a position begins: "reference_" beside a specific force."""
    return "reference_" if "specific_force_x" in chosen else "position_"


def _note_on_position(
    names: Sequence[str], chosen: Mapping[str, str], parts: Mapping[str, str]
) -> str:
    taken = chosen.get("position_x") or chosen.get("reference_x") or ""
    platform = ", ".join(name for role, name in parts.items() if role.startswith("platform"))
    if platform and strip(taken) in PATTERNS["tower_x"]:
        return f"{_note_on_bending([taken])}: the platform's motion ({platform}) is left out"
    bodies = sorted(find_all(names, r"stateposx.*global\d*"))
    if taken in bodies and len(bodies) > 1:
        return (
            f"{taken} is the first of {len(bodies)} channels of that kind, one per body: is it the "
            "tower top (--describe lists all; columns.position_x=NAME takes another)?"
        )
    return ""


def _note_on_bending(names: Collection[str]) -> str:
    are = "is" if len(names) == 1 else "are"
    return f"{' and '.join(names)} {are} relative to the tower base, whose own motion is not in it"
