"""The hub's motion of one structure over many sea states: natural periods and amplitudes.

The points of a structure are what figure 18 of Ren et al. (2019) calls its normal envelope: where
on the map of natural period and amplitude the structure is, with 0 to 2 blades mounted, on looser
or denser sand, in the seas of section 2.1. The wave forces depend on the sea alone, so they are
computed once for all numbers of blades and all soils.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np
import pandas as pd

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.motion import whittle
from owtsweep.motion.plant import Plant, draw_forces, respond
from owtsweep.motion.source import interleaved
from owtsweep.streams import Streams
from owtsweep.structures import Modes, Structure
from owtsweep.waves import Sea

#: Significant wave heights (m) and peak periods (s): the range of offshore operations in section
#: 2.1 of Ren et al. (2019), H_s up to 3 m and T_p from 4 to 10 s.
HEIGHTS = tuple(0.5 * number for number in range(1, 7))
PERIODS = tuple(float(number) for number in range(4, 11))
#: Numbers of mounted blades: with the third blade the installation is over.
BLADES = (0, 1, 2)
#: Friction angles (degrees) of every layer of the soil; None keeps those of the description.
FRICTION_ANGLES = (None, 28.0, 32.0, 36.0, 40.0)
#: Samples per second. At .3 Hz the largest sample is within .2 % of the largest displacement.
RATE = 20.0
#: Share of the points that the region holds.
SHARE = 0.95
#: Points whose natural periods differ by at most this much (s) are pooled for the region's edges.
#: One record's largest displacement scatters by some 10 %, and so would the edges.
POOLED = 0.15


def list_seas() -> list[Sea]:
    """Return the sea states of `HEIGHTS` and `PERIODS` that are found at sea (`Sea.is_found`)."""
    seas = [Sea(hs, tp) for hs in HEIGHTS for tp in PERIODS]
    return [sea for sea in seas if sea.is_found]


def compute_points(
    structure: Structure,
    seas: Sequence[Sea],
    stream: Streams,
    *,
    duration: float,
    blades: Sequence[int] = BLADES,
    friction_angles: Sequence[float | None] = FRICTION_ANGLES,
) -> pd.DataFrame:
    """Compute natural period and size of the hub's motion in each sea, for all blades and soils.

    Raise `InputError` if the structure does not stand in water or has no such modes, or the records
    are too short.

    Return one row per sea, number of blades and friction angle (NaN: as described): hs (m), tp (s),
    blades, friction_angle (degrees), natural_period (s, of the first mode), fitted_period (s, of
    the peak of Eq. (1) of Ren et al. fitted to the record), amplitude (m, the largest displacement
    along the waves), rms (m).

    structure: the structure, which stands in water.
    stream: function that returns a new random generator, given a name; it is called with "phase".
        All sea states have the same phases.
    duration: Length of a record, s.
    blades: Numbers of mounted blades; ignored if the structure has no blade.
    friction_angles: Friction angles (degrees) of every layer; None keeps those of the description.
        Ignored if the structure has no soil.
    """
    require(len(seas) > 0, "seas: the list is empty; give at least one sea state")
    variants = list(_vary(structure, seas[0], blades, friction_angles))
    steps, rows = round(duration * RATE), []
    for sea in seas:
        heights, forces = draw_forces(structure, sea, stream("phase"), 2.0 * duration)
        for mounted, angle, modes in variants:
            hub = respond(modes, heights, forces, 2.0 * duration).sum(axis=0)
            position = interleaved(hub, 2 * steps).T.reshape(-1)[:steps]
            rows.append(
                {
                    "hs": sea.hs,
                    "tp": sea.tp,
                    "blades": mounted,
                    "friction_angle": np.nan if angle is None else angle,
                    "natural_period": 1.0 / float(modes.frequency[0]),
                    "fitted_period": whittle.fit(position, 1.0 / RATE).natural_period,
                    "amplitude": float(np.abs(position).max()),
                    "rms": float(position.std()),
                }
            )
    return pd.DataFrame(rows)


def _vary(
    structure: Structure, sea: Sea, blades: Sequence[int], friction_angles: Sequence[float | None]
) -> Iterator[tuple[int, float | None, Modes]]:
    """Yield number of blades, friction angle and modes of each variant of a structure."""
    for angle in friction_angles if structure.soil is not None else (None,):
        varied = structure
        if angle is not None and structure.soil is not None:
            varied = structure.model_copy(update={"soil": structure.soil.with_angle(angle)})
        for mounted in blades if structure.blade is not None else (0,):
            yield mounted, angle, Plant(varied, sea, mounted).vibration


def find_region(points: pd.DataFrame) -> tuple[Array, Array, Array]:
    """Find the region of natural periods and amplitudes that holds the part `SHARE` of all points.

    At each natural period the region reaches from the (1 - SHARE)/2 to the (1 + SHARE)/2 quantile
    of the amplitudes of the points with about this natural period (`POOLED`); all points count
    alike. Points with the same blades and soil have the same natural period. Between these periods
    the edges are straight lines. `points` are those of `compute_points`.

    Return natural periods (s), increasing, and the edges of the region there (m), shape (periods,).
    """
    period, amplitude = points["natural_period"].to_numpy(), points["amplitude"].to_numpy()
    places = np.unique(period)
    ends = [0.5 * (1.0 - SHARE), 0.5 * (1.0 + SHARE)]
    near = [amplitude[np.abs(period - place) <= POOLED] for place in places]
    low, high = np.array([np.quantile(sizes, ends) for sizes in near]).T
    return places, low, high
