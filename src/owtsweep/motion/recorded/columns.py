"""Assign a file's channels to roles such as "time" or "position_x": what a channel holds."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches
from functools import lru_cache

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require
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
TIME_NAMES = (
    "time", "t", "timestamp", "times", "timesec", "seconds", "elapsedtime", "scantime", "time.*",
)  # fmt: skip

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


@lru_cache(maxsize=1 << 14)
def strip(name: str) -> str:
    """Return a name in lower case, with nothing but its letters and digits."""
    return re.sub(r"[^a-z0-9]", "", name.lower())


def find(names: Sequence[str], *patterns: str) -> str | None:
    """Return the first channel whose name matches a pattern, earlier patterns first."""
    return next((name for pattern in patterns for name in find_all(names, pattern)), None)


def find_all(names: Sequence[str], pattern: str) -> list[str]:
    """Return the channels whose names match a pattern."""
    return [name for name in names if re.fullmatch(pattern, strip(name))]


def guess_roles(names: Sequence[str]) -> dict[str, str]:
    """Assign channels to roles by well-known names: return role -> channel.

    Both axes come from one pair of names; y may be missing. Beside a specific force, positions
    become the reference if there is none.
    """
    roles: dict[str, str | None] = {"time": find(names, *TIME_NAMES)}
    for quantity, pairs in NAME_PAIRS.items():
        for along_x, along_y in pairs:
            if x := find(names, along_x):
                roles |= {f"{quantity}_x": x, f"{quantity}_y": find(names, along_y)}
                break
    found = {role: name for role, name in roles.items() if name is not None}
    if "specific_force_x" in found and "reference_x" not in found:
        for axis in "xy":
            if f"position_{axis}" in found:
                found[f"reference_{axis}"] = found.pop(f"position_{axis}")
    return found


def assign_roles(table: ChannelTable, given: Mapping[str, str]) -> dict[str, str]:
    """Assign channels to roles as given, and guess the other roles: return role -> channel.

    `given` is role -> channel name; "" leaves a role out. If only one axis of a quantity is given,
    the other is the channel whose name has y in place of x, if there is one.

    Raises InputError: for an unknown role, or a channel that the file does not have.
    """
    names = table.names
    chosen: dict[str, str] = {}
    for role, name in given.items():
        listed = ", ".join(ROLES)
        require(role in ROLES, f"{table.path}: columns.{role}: no such role: use one of {listed}")
        if name:
            chosen[role] = find_channel(table, name, f"columns.{role}")
    told = dict(chosen)
    for role, name in guess_roles([name for name in names if name not in told.values()]).items():
        if role not in given and _other_axis(role) not in given:
            chosen[role] = name
    for role, name in told.items():
        partner = _other_axis(role)
        channel = _find_partner(names, name, role[-1]) if partner in ROLES else None
        if channel and partner not in given and channel not in chosen.values():
            chosen[partner] = channel
    # beside fixes, and without a motion that they could belong to, accelerations are an IMU's
    felt = [role for role in chosen if role.startswith("acceleration_")]
    other = {"position_x", "specific_force_x"} & chosen.keys()
    if "fix_x" in chosen and not other and not {*felt} & given.keys():
        for role in felt:
            chosen[role.replace("acceleration", "specific_force")] = chosen.pop(role)
    return chosen


def _other_axis(role: str) -> str:
    return role[:-1] + OTHER.get(role[-1], "")  # position_x becomes position_y


def _find_partner(names: Sequence[str], name: str, axis: str) -> str | None:
    swap = {axis: OTHER[axis], axis.upper(): OTHER[axis].upper()}
    turned = [
        name[:place] + swap[letter] + name[place + 1 :]
        for place, letter in enumerate(name)
        if letter in swap
    ]
    return next((candidate for candidate in turned if candidate in names), None)


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
    raise InputError(
        f"{table.path}: {argument}: no channel {wanted!r}; there are {list_names(table, wanted)}"
    )


def list_names(table: ChannelTable, wanted: str = "") -> str:
    """Return the first names of a file, for messages; before them those similar to `wanted`."""
    lower = {name.lower(): name for name in table.names}
    near = get_close_matches(wanted.lower(), lower, n=12, cutoff=0.4)
    listed = list(dict.fromkeys([*(lower[text] for text in near), *table.names]))[:12]
    left = len(table.names) - len(listed)
    return ", ".join(listed) + (f" and {left} more (--describe lists all)" if left else "")


def refuse_without_time(table: ChannelTable, hint: str) -> InputError:
    """Return the error for a file without time; `hint` says how to name it."""
    return InputError(f"{table.path}: no time column found among {list_names(table)}: {hint}")


def imply_unit(role: str, name: str) -> str:
    """Return the unit that FAST always uses for a channel, e.g. "deg" for PtfmPitch; else ""."""
    return "deg" if PARTS.get(role) == "angle" and strip(name).startswith("ptfm") else ""


def find_factors(
    table: ChannelTable,
    columns: Mapping[str, str],
    dimensions: Mapping[str, str],
    given: Mapping[str, str | None],
    setting: str,
) -> dict[str, float | None]:
    """Find the factors to SI of the units of channels: role -> factor, None if there is no unit.

    columns, dimensions: role -> channel, and what it holds. given: role -> unit as the user says by
        `setting`, e.g. "units.ROLE". It goes before the file's unit, and this before the unit that
        a channel of this name always has.
    Raises InputError if a unit is not known or is not of the dimension.
    """
    factors: dict[str, float | None] = {}
    for role, name in columns.items():
        dimension, unit, key = dimensions[role], given.get(role), setting.replace("ROLE", role)
        stated = table.unit(name) or imply_unit(role, name)
        if dimension == "time" and stated == ISO_TIME:
            require(
                not unit,
                f"{table.path}: {key}={unit}: the times ({name}) are dates with a time of day, "
                f"which become seconds; leave out {key}",
            )
            factors[role] = 1.0
        elif unit:
            factors[role] = find_factor(unit, dimension, f"{table.path}: {key}")
        elif stated:
            said = f"{table.path}: channel {name} says its unit is"
            factors[role] = find_factor(stated, dimension, said, f"; or give the unit by {key}")
        else:
            factors[role] = None
    return factors


def to_si(
    loaded: Mapping[str, Array], columns: Mapping[str, str], factors: Mapping[str, float | None]
) -> dict[str, Array]:
    """Return role -> values in SI units, from channel -> values; infinite values become NaN.

    Arrays are changed in place, to save memory, unless a channel has two roles.
    """
    result: dict[str, Array] = {}
    for role, name in columns.items():
        shared = list(columns.values()).count(name) > 1
        values = loaded[name].copy() if shared else loaded[name]
        with np.errstate(over="ignore"):
            values *= factors[role] or 1.0
        values[~np.isfinite(values)] = np.nan
        result[role] = values
    return result
