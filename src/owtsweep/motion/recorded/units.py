"""Knows the units that recordings may use, and their factors to SI."""

from __future__ import annotations

import math
import re

from owtsweep.errors import require
from owtsweep.gravity import STANDARD_GRAVITY

DEGREE = math.pi / 180
#: dimension -> (SI unit, unit -> factor to SI). Latitudes and longitudes stay in degrees.
DIMENSIONS: dict[str, tuple[str, dict[str, float]]] = {
    "time": ("s", {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9, "min": 60.0, "h": 3600.0}),
    "length": ("m", {
        "m": 1.0, "mm": 1e-3, "cm": 1e-2, "um": 1e-6, "km": 1e3, "ft": 0.3048, "in": 0.0254,
    }),
    "velocity": ("m/s", {
        "m/s": 1.0, "mm/s": 1e-3, "cm/s": 1e-2, "km/h": 1 / 3.6, "kt": 1852 / 3600, "ft/s": 0.3048,
    }),
    "acceleration": ("m/s^2", {
        "m/s^2": 1.0, "mm/s^2": 1e-3, "cm/s^2": 1e-2,
        "g": STANDARD_GRAVITY, "mg": 1e-3 * STANDARD_GRAVITY, "ft/s^2": 0.3048,
    }),
    "angle": ("rad", {"rad": 1.0, "deg": DEGREE, "mrad": 1e-3}),
    "angular velocity": ("rad/s", {"rad/s": 1.0, "deg/s": DEGREE, "mrad/s": 1e-3}),
    "latitude or longitude": ("deg", {"deg": 1.0, "rad": 1 / DEGREE}),
    "force": ("N", {"N": 1.0, "kN": 1e3, "MN": 1e6}),
    "moment": ("Nm", {"Nm": 1.0, "kNm": 1e3, "MNm": 1e6}),
}  # fmt: skip
#: Force or moment; case matters, because mN is not MN.
_LOAD = re.compile(r"[kM]?Nm?")

#: Other spellings of units, in lower case and without blanks.
SPELLINGS = {
    "sec": "s", "secs": "s", "second": "s", "seconds": "s", "msec": "ms", "µs": "us",
    "minutes": "min", "hours": "h", "meter": "m", "metre": "m", "meters": "m", "metres": "m",
    "µm": "um", "knots": "kt", "gee": "g", "gn": "g", "degree": "deg", "degrees": "deg",
    "°": "deg", "radians": "rad",
}  # fmt: skip


def normalise_unit(unit: str) -> str:
    """Return a unit in one spelling: `m/s2`, `m/s**2`, `m s-2` and `m/sec^2` become `m/s^2`."""
    load = re.sub(r"[\s*·.-]", "", unit)
    if _LOAD.fullmatch(load):
        return load
    text = unit.strip().lower()
    for old, new in (("**", "^"), ("²", "^2"), ("·", " "), ("*", " ")):
        text = text.replace(old, new)
    for old, new in ((" s^-2", "/s^2"), (" s-2", "/s^2"), (" s^-1", "/s"), (" s-1", "/s")):
        text = text.replace(old, new)
    text = "".join(text.split())
    text = text.replace("/sec", "/s").replace("/s/s", "/s^2").replace("/s2", "/s^2")
    whole, slash, time = text.partition("/")
    return SPELLINGS.get(whole, whole) + slash + time


def find_dimension(unit: str) -> str | None:
    """Return the dimension of a unit, e.g. "length"; None for a unit not in `DIMENSIONS`."""
    spelling = normalise_unit(unit)
    return next((name for name, (_, table) in DIMENSIONS.items() if spelling in table), None)


def find_factor(unit: str, wanted: str, argument: str, hint: str = "") -> float:
    """Return the factor from a unit to the SI unit of the dimension `wanted`, e.g. "length".

    Raises InputError, from `argument` to `hint`, if the unit is unknown or of another dimension.
    """
    si, table = DIMENSIONS[wanted]
    spelling, other = normalise_unit(unit), find_dimension(unit)
    reason = f"is a unit of {other}, not of {wanted}" if other else "is not a unit known here"
    require(
        spelling in table,
        f"{argument}: {unit!r} {reason}: use one of {', '.join(table)} (SI: {si}){hint}",
    )
    return table[spelling]
