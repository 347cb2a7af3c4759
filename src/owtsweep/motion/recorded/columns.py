"""Assign a file's channels to roles such as "time" or "position_x": what a channel holds."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.recorded.formats.table import ChannelTable
from owtsweep.motion.recorded.formats.text_layout import ISO_TIME
from owtsweep.motion.recorded.units import find_factor

#: The quantities that a channel can hold, with their dimensions (see `units`). `_x` points north or
#: along the first horizontal axis, `_y` east or along the second.
QUANTITIES = {
    "position": "length",
    "velocity": "velocity",
    "acceleration": "acceleration",
    "specific_force": "acceleration",
    "fix": "length",
    "reference": "length",
}

#: Parts of the motion of the hub, with their dimensions: the platform's translation and rotation,
#: and the displacement of the tower top in the tower's frame. `composing` makes a position of them.
PARTS = {
    "platform_surge": "length",
    "platform_sway": "length",
    "platform_roll": "angle",
    "platform_pitch": "angle",
    "platform_yaw": "angle",
    "tower_x": "length",
    "tower_y": "length",
    "tower_z": "length",
}

#: role -> dimension
ROLES = {
    "time": "time",
    **{f"{name}_{axis}": kind for name, kind in QUANTITIES.items() for axis in "xy"},
    "yaw": "angle",
    **PARTS,
}

#: The other axis.
OTHER = {"x": "y", "y": "x"}

#: Names of time in order of preference; case and all but letters and digits are ignored.
TIME_NAMES = ("time", "t", "timestamp", "times", "timesec", "seconds", "elapsedtime", "scantime")

#: quantity -> pairs of patterns (x, y) in order of preference. A pattern must match the whole name,
#: of which case and all but letters and digits are ignored. HAWC2: the state of a body in global
#: coordinates, x and y horizontal. `choosing` knows the positions of FAST and
#: OpenFAST.
NAME_PAIRS: dict[str, tuple[tuple[str, str], ...]] = {
    "position": (
        ("positionx|posx|displacementx|dispx", "positiony|posy|displacementy|dispy"),
        ("positionnorth|posnorth|north|northing", "positioneast|poseast|east|easting"),
        ("x|px", "y|py"),
        ("stateposx.*global", "stateposy.*global"),
    ),
    "velocity": (
        ("velocityx|velx|vx", "velocityy|vely|vy"),
        ("velocitynorth|velnorth|vnorth|vn", "velocityeast|veleast|veast|ve"),
        ("statevelx.*global", "statevely.*global"),
    ),
    "acceleration": (
        ("accelerationx|ax", "accelerationy|ay"),
        ("stateaccx.*global", "stateaccy.*global"),
    ),
    "specific_force": (
        ("specificforcex|specforcex|sfx", "specificforcey|specforcey|sfy"),
        ("(imu)?acc(el|elerometer)?x", "(imu)?acc(el|elerometer)?y"),
        ("imuax|imux", "imuay|imuy"),
    ),
    "fix": (
        ("fixx|gnssx|gpsx|rtkx", "fixy|gnssy|gpsy|rtky"),
        ("(gnss|gps|rtk|fix)n(orth)?", "(gnss|gps|rtk|fix)e(ast)?"),
    ),
    "reference": (
        (
            "reference(position)?x|refx|opticalx|optx|mocapx|truex|truthx",
            "reference(position)?y|refy|opticaly|opty|mocapy|truey|truthy",
        ),
    ),
}


def strip(name: str) -> str:
    """Return a name in lower case, with nothing but its letters and digits."""
    return re.sub(r"[^a-z0-9]", "", name.lower())


def find(names: Sequence[str], pattern: str) -> str | None:
    """Return the first channel that matches the alternatives of a pattern, earlier ones first."""
    for part in pattern.split("|"):
        for name in names:
            if re.fullmatch(part, strip(name)):
                return name
    return None


def find_all(names: Sequence[str], pattern: str) -> list[str]:
    """Return the channels whose names match a pattern, sorted."""
    return sorted(name for name in names if re.fullmatch(pattern, strip(name)))


def guess_roles(names: Sequence[str]) -> dict[str, str]:
    """Assign channels to roles by well-known names: return role -> channel.

    Both axes come from one pair of names; y may be missing. Beside a specific force, positions
    become the reference if there is none.
    """
    bare = {name: strip(name) for name in names}

    def first(pattern: str) -> str | None:
        return next((name for name, text in bare.items() if re.fullmatch(pattern, text)), None)

    roles: dict[str, str] = {}
    time = next((hit for pattern in (*TIME_NAMES, "time.*") if (hit := first(pattern))), None)
    if time is not None:
        roles["time"] = time
    for quantity, pairs in NAME_PAIRS.items():
        for along_x, along_y in pairs:
            x, y = first(along_x), first(along_y)
            if x is not None:
                roles[f"{quantity}_x"] = x
                if y is not None:
                    roles[f"{quantity}_y"] = y
                break
    if "specific_force_x" in roles and "reference_x" not in roles:
        for axis in "xy":
            if f"position_{axis}" in roles:
                roles[f"reference_{axis}"] = roles.pop(f"position_{axis}")
    return roles


def assign_roles(table: ChannelTable, given: Mapping[str, str | None]) -> dict[str, str]:
    """Assign channels to roles as given, and guess the other roles: return role -> channel.

    `given` is role -> channel name; None or "" leaves a role out. If only one axis of a quantity is
    given, the other is the channel whose name has y in place of x, if there is one.

    Raises InputError: for an unknown role, or a channel that the file does not have.
    """
    names = table.names
    chosen: dict[str, str] = {}
    for role, name in given.items():
        where = f"columns.{role}"
        if role not in ROLES:
            raise InputError(f"{table.path}: {where}: no such role: use one of {', '.join(ROLES)}")
        if name is not None and str(name).strip():
            chosen[role] = find_channel(table, str(name).strip(), where)
    taken = set(chosen.values())
    for role, name in guess_roles([name for name in names if name not in taken]).items():
        axes = (role, role[:-1] + OTHER.get(role[-1], ""))
        if not any(axis in given for axis in axes):
            chosen[role] = name
    for role, name in list(chosen.items()):
        partner = role[:-1] + OTHER.get(role[-1], "")
        if role in given and partner in ROLES and partner not in given:
            channel = _find_partner(names, name, role[-1])
            if channel is not None and channel not in chosen.values():
                chosen[partner] = channel
    # beside fixes, and without a motion that they could belong to, accelerations are an IMU's
    felt = [role for role in chosen if role.startswith("acceleration_")]
    other = {"position_x", "specific_force_x"} & chosen.keys()
    if "fix_x" in chosen and not other and not {*felt} & given.keys():
        for role in felt:
            chosen[role.replace("acceleration", "specific_force")] = chosen.pop(role)
    return chosen


def _find_partner(names: Sequence[str], name: str, axis: str) -> str | None:
    swap = {axis: OTHER[axis], axis.upper(): OTHER[axis].upper()}
    for place, letter in enumerate(name):
        if letter in swap:
            candidate = name[:place] + swap[letter] + name[place + 1 :]
            if candidate in names:
                return candidate
    return None


def find_channel(table: ChannelTable, wanted: str, argument: str) -> str:
    """Return the name of the channel called `wanted`, spelled as in the file.

    Case matters only if two names differ by case alone. If no name fits, a unit in brackets at the
    end of `wanted` is ignored. `argument` is the setting that names the channel.

    Raises InputError if there is no such channel; the most similar names are listed first.
    """
    names = table.names
    if wanted in names:
        return wanted
    without_unit = re.sub(r"[\s_]*[\[(][^\[\]()]*[\])]\s*$", "", wanted)
    for text in (wanted, without_unit):
        hits = [name for name in names if name.lower() == text.lower()]
        if len(hits) == 1:
            return hits[0]
    lower = {name.lower(): name for name in names}
    near = [lower[text] for text in get_close_matches(wanted.lower(), lower, n=12, cutoff=0.4)]
    listed = (near + [name for name in names if name not in near])[:12]
    left = len(names) - len(listed)
    more = f" and {left} more (--describe lists all)" if left else ""
    reason = f"{argument}: no channel {wanted!r}; there are {', '.join(listed)}{more}"
    raise InputError(f"{table.path}: {reason}")


def list_names(table: ChannelTable) -> str:
    """Return the first names of a file, for messages."""
    return ", ".join(table.names[:12]) + (" ..." if len(table.names) > 12 else "")


def refuse_without_time(table: ChannelTable, setting: str) -> InputError:
    """Return the error for a file without time; `setting` would name it."""
    return InputError(
        f"{table.path}: no time column found among {list_names(table)}: set {setting}"
    )


def find_scale(
    table: ChannelTable,
    name: str,
    dimension: str,
    given: str | None,
    setting: str,
    implied: str = "",
) -> float | None:
    """Return the factor to SI of a channel's unit; None if there is no unit.

    What the user gives by `setting` goes before the file's unit, and this before an `implied` one.

    Raises InputError if the unit is not known or is not of the dimension.
    """
    stated = table.unit(name) or implied
    if dimension == "time" and stated == ISO_TIME:
        if given:
            raise InputError(
                f"{table.path}: {setting}={given}: the times ({name}) are dates with a time of "
                f"day, which become seconds; leave out {setting}"
            )
        return 1.0
    if given:
        return find_factor(given, dimension, f"{table.path}: {setting}")
    if not stated:
        return None
    try:
        return find_factor(stated, dimension, f"{table.path}: channel {name} says its unit is")
    except InputError as error:
        raise InputError(f"{error}; or give the unit by {setting}") from None


def to_si(
    loaded: Mapping[str, Array], names: Mapping[str, str], factors: Mapping[str, float]
) -> dict[str, Array]:
    """Return role -> values in SI units, from channel -> values; infinite values become NaN.

    Arrays are changed in place, to save memory, unless a channel has two roles.
    """
    result: dict[str, Array] = {}
    for role, name in names.items():
        values = loaded[name]
        if list(names.values()).count(name) > 1 or not values.flags.writeable:
            values = values.copy()
        with np.errstate(over="ignore"):
            values *= factors[role]
        values[~np.isfinite(values)] = np.nan
        result[role] = values
    return result
