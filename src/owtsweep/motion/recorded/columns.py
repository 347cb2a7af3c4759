"""Which channel plays which role: given by the user, or guessed from well-known names."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from difflib import get_close_matches

from owtsweep.errors import InputError

#: What a channel can be, and its dimension (see `units`). `_x` points north or along the first
#: horizontal axis, `_y` east or along the second.
QUANTITIES = {
    "position": "length",
    "velocity": "velocity",
    "acceleration": "acceleration",
    "specific_force": "acceleration",
    "fix": "length",
    "reference": "length",
}

#: role -> dimension
ROLES = {
    "time": "time",
    **{f"{name}_{axis}": kind for name, kind in QUANTITIES.items() for axis in "xy"},
    "yaw": "angle",
}

#: The other axis.
OTHER = {"x": "y", "y": "x"}

#: Names of time, in the order of preference; compared without case, blanks and signs.
TIME_NAMES = ("time", "t", "timestamp", "times", "timesec", "seconds", "elapsedtime", "scantime")

#: quantity -> pairs of patterns (x, y) for a whole name without case, blanks and signs, in the
#: order of preference. FAST: TwHt1TPxi is the position of a tower node in the inertial frame,
#: YawBrTDxt and TTDspFA the deflection of the tower top from where it stood. HAWC2: the state of a
#: body in global coordinates, whose x and y are horizontal.
NAME_PAIRS: dict[str, tuple[tuple[str, str], ...]] = {
    "position": (
        ("positionx|posx|displacementx|dispx", "positiony|posy|displacementy|dispy"),
        ("positionnorth|posnorth|north|northing", "positioneast|poseast|east|easting"),
        ("x|px", "y|py"),
        ("twht1tpxi", "twht1tpyi"),
        ("yawbrtdxt", "yawbrtdyt"),
        ("ttdspfa", "ttdspss"),
        ("ptfmsurge", "ptfmsway"),
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


def _bare(name: str) -> str:
    return re.sub(r"[^a-z0-9]", "", name.lower())


def guess(names: Sequence[str]) -> dict[str, str]:
    """role -> channel, from well-known names; a role nobody plays is absent.

    Both axes of a quantity come from one pair of names, or x alone. Positions beside a specific
    force are what the estimates are compared with: they become the reference if there is none.
    """
    bare = {name: _bare(name) for name in names}

    def first(pattern: str) -> str | None:
        return next((name for name, text in bare.items() if re.fullmatch(pattern, text)), None)

    found: dict[str, str] = {}
    time = next((hit for pattern in TIME_NAMES if (hit := first(pattern))), None)
    if time is None:
        time = first("time.*")
    if time is not None:
        found["time"] = time
    for quantity, pairs in NAME_PAIRS.items():
        for along_x, along_y in pairs:
            x, y = first(along_x), first(along_y)
            if x is not None:
                found[f"{quantity}_x"] = x
                if y is not None:
                    found[f"{quantity}_y"] = y
                break
    if "specific_force_x" in found and "reference_x" not in found:
        for axis in "xy":
            if f"position_{axis}" in found:
                found[f"reference_{axis}"] = found.pop(f"position_{axis}")
    return found


def assign(names: Sequence[str], given: Mapping[str, str | None]) -> dict[str, str]:
    """role -> channel: what is given, and the guess for what is not.

    Parameters
    ----------
    names
        The channels of the file.
    given
        role -> channel name; None or "" keeps a role from being guessed. A channel that is given
        one role is not guessed into another, and where one axis is given the other is the channel
        whose name differs by x for y, or none.

    Raises
    ------
    InputError
        For an unknown role, or a channel that the file does not have.
    """
    chosen: dict[str, str] = {}
    for role, name in given.items():
        if role not in ROLES:
            raise InputError(f"columns.{role}: no such role: use one of {', '.join(ROLES)}")
        if name is not None and str(name).strip():
            chosen[role] = find(names, str(name).strip(), f"columns.{role}")
    taken = set(chosen.values())
    for role, name in guess([name for name in names if name not in taken]).items():
        axes = (role, role[:-1] + OTHER.get(role[-1], ""))
        if not any(axis in given for axis in axes):
            chosen[role] = name
    for role, name in list(chosen.items()):
        partner = role[:-1] + OTHER.get(role[-1], "")
        if role in given and partner in ROLES and partner not in given:
            found = _partner(names, name, role[-1])
            if found is not None and found not in chosen.values():
                chosen[partner] = found
    return chosen


def _partner(names: Sequence[str], name: str, axis: str) -> str | None:
    """The channel whose name differs in one letter alone: x for y or y for x."""
    swap = {axis: OTHER[axis], axis.upper(): OTHER[axis].upper()}
    for place, letter in enumerate(name):
        if letter in swap:
            candidate = name[:place] + swap[letter] + name[place + 1 :]
            if candidate in names:
                return candidate
    return None


def find(names: Sequence[str], wanted: str, argument: str) -> str:
    """The channel of that name; case counts only where two differ by nothing else.

    Raises
    ------
    InputError
        If there is none: lists what is there, similar names first, at most 12.
    """
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
    more = f" and {len(names) - len(listed)} more (--describe)" if len(names) > len(listed) else ""
    raise InputError(f"{argument}: no channel {wanted!r}; there are {', '.join(listed)}{more}")
