"""The boundary of two schemes: the amplitude at which they are equally good, over the period.

It also refuses settings of SWITCH that cannot work.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import isnan, log

import numpy as np

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.errors import InputError, require
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import LISTED, resolve, under
from owtsweep.studies.hub.scheme_sections import Switch

#: Number of frequencies in the band at which a computed boundary is tabulated.
FREQUENCIES = 40


#: Logarithms of the amplitudes (m) that stand for "none" and for "any": far from every motion.
NONE, ANY = -30.0, 30.0


@dataclass(frozen=True)
class Boundary:
    """A table of amplitudes over periods.

    log_period: logarithms of the periods in s, rising, shape (n,).
    log_amplitude: logarithms of the amplitudes in m, shape (n,). `NONE`: the scheme above the
        boundary is better at every amplitude; `ANY`: the scheme below it is.
    """

    log_period: Array
    log_amplitude: Array

    def amplitude(self, period: float) -> float:
        """Return the amplitude (m) at a period (s), interpolated between logarithms.

        Beyond its ends the table keeps its end values. For a period of NaN, its least amplitude is
        taken.
        """
        if isnan(period):
            return float(np.exp(self.log_amplitude.min()))
        return float(np.exp(np.interp(log(period), self.log_period, self.log_amplitude)))


def read_boundary(points: Sequence[Sequence[float]]) -> Boundary:
    """Return the boundary of the key `switch.boundary`: rising periods (s) and amplitudes (m).

    Raises InputError if it is no table of such numbers above zero.
    """
    example = "give pairs of natural period (s) and amplitude (m), e.g. [[4,0.7],[8,1.2]]"
    if not points or any(len(point) != 2 for point in points):
        raise InputError(f"switch.boundary: {points!r} is no list of pairs; {example}")
    table = np.array(points, dtype=float)
    if not np.all(table > 0.0):
        raise InputError(
            f"switch.boundary: the number {table.min():g} is not above zero; {example}"
        )
    if np.any(np.diff(table[:, 0]) <= 0.0):
        raise InputError("switch.boundary: the periods do not rise; give them in order")
    return Boundary(np.log(table[:, 0]), np.log(table[:, 1]))


def compute_boundary(config: HubConfig, below: str, above: str, crest: float) -> Boundary:
    """Compute the boundary of two schemes from their expected errors, without records.

    A motion that is almost a sinusoid of period T makes the settled mean square error v C(1/T) +
    noise, where v is the motion's mean square and C the scheme's error by frequency
    (`error_curves.curves`). The boundary is where the two schemes' errors are equal.

    below, above: names of the schemes used below and above the boundary.
    crest: amplitude of the motion divided by the root mean square of the displacement.
    Raises InputError if a scheme's expected errors cannot be computed: it is not linear, or has no
    kernel.
    """
    from owtsweep.studies.hub.error_curves.of_schemes import curves_of

    measure = int(config.measures.criterion == "velocity")
    alone = changed(config, schemes=[below, above], baselines=[])
    for name in (below, above):
        scheme = under(resolve(name), alone)
        if not (scheme.linear and scheme.batched == "chain"):
            raise InputError(
                f"switch.boundary: {name} is not linear or has no kernel, so its boundary cannot "
                "be computed; give a table of periods and amplitudes"
            )
    frequency = np.geomspace(config.band[1], config.band[0], FREQUENCIES)
    curves = [curves_of(alone, name) for name in (below, above)]
    motion = [curve.at(frequency)[measure, 1] for curve in curves]
    noise = [2.0 * float(curve.noise[:, measure, 1].sum()) for curve in curves]  # of both axes
    gained, paid = motion[0] - motion[1], noise[1] - noise[0]
    if paid <= 0.0:
        # The scheme above has less noise too. Where it follows the motion worse, it is better at
        # small amplitudes alone, and one boundary cannot say so: it is then never chosen.
        amplitude = np.where(gained >= 0.0, NONE, ANY)
    else:
        amplitude = np.full(FREQUENCIES, ANY)
        better = gained > 0.0
        amplitude[better] = np.log(crest) + 0.5 * np.log(paid / gained[better])
    return Boundary(-np.log(frequency), np.clip(amplitude, NONE, ANY))


def check_switch(own: str, settings: Switch) -> None:
    """Raise `InputError` unless `switch` names two other schemes and its boundary is a table."""
    others = ", ".join(name for name in LISTED if name != own)
    for key, name in (("below", settings.below), ("above", settings.above)):
        require(name in LISTED, f"switch.{key}: there is no scheme {name!r}; use {others}")
        require(
            name != own,
            f"switch.{key}: {own} cannot switch to itself; name another scheme, e.g. HME1",
        )
    require(
        settings.below != settings.above,
        f"switch.above: {settings.above} is below the boundary too; name two different schemes",
    )
    if settings.boundary is not None:
        read_boundary(settings.boundary)
