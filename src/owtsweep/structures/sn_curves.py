"""S-N curves: how many cycles of a stress range a weld stands.

The curves of DNV-RP-C203 are in data/dnv_rp_c203.yaml, with the source. They are design curves
(mean less two standard deviations) for walls up to 25 mm; the standard's correction for thicker
walls is left out, as it is in Simpson et al. (2025). `paper` is the line printed there.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from importlib import resources
from typing import Any, Literal

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import Finite, Positive, Section, key, require
from owtsweep.config.hints import suggest_name
from owtsweep.errors import InputError

#: Stress unit of S-N curves, Pa.
MPA = 1e6
#: How far apart, in log10 of cycles, two branches may be at the knee. (A table rounded to three
#: decimals leaves .003.)
GAP = 0.02
#: The weld of Simpson et al. (2025), after Eq. (31). It is the second branch of the class W3.
PAPER = (5.0, 13.617)


@dataclass(frozen=True)
class SNCurve:
    """An S-N curve of one or two branches, log10 N = log_a - m log10(S / 1 MPa).

    `m`, `log_a`: exponent of each branch, and log10 of the cycles to failure at a stress range of 1
    MPa. `knee`: number of cycles up to which the first branch holds; infinite for a single branch.
    """

    m: tuple[float, ...]
    log_a: tuple[float, ...]
    knee: float = np.inf

    @property
    def knee_range(self) -> float:
        """The stress range (Pa) from which upwards the first branch holds; 0 for one branch."""
        exponent = (self.log_a[0] - np.log10(self.knee)) / self.m[0]
        return float(MPA * 10.0**exponent)

    def spend(self, ranges: Array) -> Array:
        """Return the share 1/N of a weld's life that one cycle spends, for stress ranges in Pa."""
        stress = ranges / MPA
        with np.errstate(over="ignore"):  # to infinity, if a scheme's estimate runs away
            first = 10.0 ** -self.log_a[0] * stress ** self.m[0]
            last = 10.0 ** -self.log_a[-1] * stress ** self.m[-1]
        return np.asarray(np.where(ranges >= self.knee_range, first, last))


class Branch(Section):
    """A branch of a user's own S-N curve, log10 N = log_a - m log10(S / 1 MPa)."""

    m: Positive = key("exponent")
    log_a: Finite = key("log10 of the cycles to failure at a stress range of 1 MPa (intercept)")


class Fatigue(Section):
    """The section `fatigue`: welds and material."""

    curve: str = key(
        "class of all welds in DNV-RP-C203 (B1, B2, C ... W3), `paper`, or `own`", default="D"
    )
    environment: Literal["height", "air", "seawater"] = key(
        "table of DNV-RP-C203: air, seawater (with cathodic protection), or by the weld's height "
        "(seawater below mean sea level)",
        default="height",
    )
    branches: list[Branch] = key(
        "with curve=own: m and log_a of one branch or two", default_factory=list
    )
    knee: Positive | None = key(
        "with two branches of one's own: cycles up to which the first one holds", default=None
    )
    ultimate_strength: Positive = key("for Goodman's correction", unit="Pa", default=5e8)

    def check(self) -> None:
        own = self.curve == "own"
        for name, some in (("branches", "branches"), ("knee", "a knee")):
            require(
                own or not getattr(self, name),
                f"fatigue.{name}: {self.curve!r} has {some} of its own; set fatigue.curve=own, or "
                f"leave out the {name}",
            )
        self.find_curves(np.zeros(1))

    def find_curves(self, heights: Array) -> list[SNCurve]:
        """Return the S-N curve of each weld, from the welds' heights above mean sea level (m).

        Raise `InputError` if the keys do not make an S-N curve.
        """
        if self.curve == "own":
            return [make_curve(self.branches, self.knee)] * len(heights)
        height, seawater = self.environment == "height", self.environment == "seawater"
        wet = seawater | (height & (heights < 0.0))
        return [find_curve(self.curve, "seawater" if below else "air") for below in wet]


def find_curve(name: str, environment: str = "air") -> SNCurve:
    """Return an S-N curve of DNV-RP-C203 by its class, "B1" to "W3".

    "paper" is the single branch printed by Simpson et al. (2025), in every environment.
    `environment` is "air", or "seawater" (with cathodic protection). Raise `InputError` if there is
    no such curve.
    """
    if name == "paper":
        return SNCurve(PAPER[:1], PAPER[1:])
    table = _read_table()[environment]
    names = [*table["curves"], "paper", "own"]
    require(
        name in table["curves"],
        f"fatigue.curve: no S-N curve is named {name!r}; {suggest_name(name, names)}",
    )
    numbers = table["curves"][name]
    return SNCurve(tuple(numbers["m"]), tuple(numbers["log_a"]), table["knee"])


def make_curve(branches: Sequence[Branch], knee: float | None) -> SNCurve:
    """Make an S-N curve of one's own, of one branch or two, as in `SNCurve`.

    Raise `InputError` if there is no branch, or two branches do not meet at the knee.
    """
    m, log_a = tuple(each.m for each in branches), tuple(each.log_a for each in branches)
    require(
        len(m) in (1, 2),
        f"fatigue.branches: an own S-N curve has one branch or two, not {len(m)}; give e.g. "
        "[{m: 3, log_a: 12.164}, {m: 5, log_a: 15.606}]",
    )
    if len(m) == 1:
        require(knee is None, "fatigue.knee: a single branch has no knee; leave it out")
        return SNCurve(m, log_a)
    if knee is None:
        raise InputError(
            "fatigue.knee: two branches need the number of cycles at which they meet, e.g. 1e7"
        )
    curve = SNCurve(m, log_a, knee)
    require(
        m[1] > m[0],
        f"fatigue.branches: the second branch must be flatter: m {m[1]:g} must exceed {m[0]:g}",
    )
    meeting = (m[1] * log_a[0] - m[0] * log_a[1]) / (m[1] - m[0])
    require(
        measure_gap(curve) <= GAP,
        f"fatigue.knee: the branches meet at {10.0**meeting:.3g} cycles, not at {knee:g}",
    )
    return curve


def measure_gap(curve: SNCurve) -> float:
    """Return the jump in log10 of cycles at the knee of an S-N curve of two branches."""
    stress = np.log10(curve.knee_range / MPA)
    return float(abs(curve.log_a[1] - curve.m[1] * stress - np.log10(curve.knee)))


@cache
def _read_table() -> Any:
    """Return environment -> the cycles of the knee, and class -> m and log_a."""
    import yaml

    source = resources.files("owtsweep.structures") / "data" / "dnv_rp_c203.yaml"
    return yaml.safe_load(source.read_text(encoding="utf-8"))
