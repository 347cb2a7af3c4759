"""Loads of the rotor on the top of the structure: series of a declared spectrum, or recorded ones.

Turbulence has Kaimal's spectrum (IEC 61400-1:2019, Eq. C.14, longitudinal: length scale 8.1 x 42 m
for hubs above 60 m). The rotor averages gusts smaller than itself: admittance of Vickery (1968),
1 / (1 + (2 f sqrt(A) / U)^(4/3))^2 on the spectrum. Lines once and three times per revolution are
narrow Gaussian peaks. The series repeat after twice their length, so nothing repeats inside one.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import require
from owtsweep.io.reading import expand_home
from owtsweep.motion.lines import sample_periodic
from owtsweep.motion.recorded import Signals, Wanted, read_signals
from owtsweep.streams import Streams
from owtsweep.studies.tower.sections import TopLoad, Wind

#: Length scale of the longitudinal component, m (IEC 61400-1:2019, 6.3.1 and C.14).
LENGTH_SCALE = 8.1 * 42.0
#: Width of a line over its frequency: the rotor's speed varies by some 2 %.
LINE_WIDTH = 0.02
#: Names of the loads, in the order of the columns: force and moment, fore-aft, then side-side.
NAMES = ("thrust", "moment", "side", "side_moment")
DIMENSIONS = dict(zip(NAMES, ("force", "moment", "force", "moment"), strict=True))
WANTED = Wanted("", DIMENSIONS.get, ", ".join(NAMES), NAMES)


def make_top_loads(wind: Wind, draws: Streams, *, steps: int, step: float, lead: int = 0) -> Array:
    """Draw the loads on the top, or read them from the file of the configuration.

    They are in N and N m in the order of `NAMES`, shape (lead + steps, 4); `step` is in s. There
    are at most `steps` samples of `lead` before the record, and none if a file is read. Raise
    `InputError` if the file cannot be used.
    """
    if wind.file is not None:
        return read_loads(wind.file, steps=steps, step=step)
    frequency = np.arange(1, steps) / (2 * steps * step)
    spectrum = find_spectrum(wind, frequency)
    loads = [_draw(getattr(wind, name), spectrum, draws(name), steps, lead) for name in NAMES]
    return np.stack(loads, axis=1)


def find_spectrum(wind: Wind, frequency: Array) -> Array:
    """Compute the shape of the loads' spectrum at frequencies in Hz; its sum is 1."""
    scale = LENGTH_SCALE / wind.speed
    averaged = (
        1.0 + (2.0 * frequency * np.sqrt(wind.rotor_area) / wind.speed) ** (4.0 / 3.0)
    ) ** -2
    gusts = averaged * (1.0 + 6.0 * frequency * scale) ** (-5.0 / 3.0)
    parts = [(1.0 - wind.line_1p - wind.line_3p, gusts)]
    for share, blade in ((wind.line_1p, 1), (wind.line_3p, 3)):
        line = blade * wind.rotor_speed
        parts.append((share, np.exp(-0.5 * ((frequency - line) / (LINE_WIDTH * line)) ** 2)))
    return np.asarray(sum(share * part / np.sum(part) for share, part in parts))


def _draw(
    load: TopLoad, spectrum: Array, phase: np.random.Generator, steps: int, lead: int
) -> Array:
    """Draw a series with random phases; twice the record has exactly the standard deviation."""
    bins = np.zeros(steps + 1, dtype=complex)
    turns = 2.0 * np.pi * phase.random(len(spectrum))
    bins[1:-1] = steps * load.sigma * np.sqrt(2.0 * spectrum) * np.exp(1j * turns)
    return load.mean + sample_periodic(bins, steps, lead)


def read_file(file: str) -> Signals:
    """Read the file of recorded loads; errors are those of `read_signals`."""
    return read_signals(expand_home(file), WANTED)


def read_loads(file: str, *, steps: int, step: float) -> Array:
    """Read loads, interpolated linearly at the samples of a record, (steps, 4) as `NAMES`.

    The record begins at the file's first time; `step` is in s. Raise `InputError` as
    `read_file`, or if the file is shorter than the record.
    """
    found = read_file(file)
    time, length = found.time - found.time[0], (steps - 1) * step
    require(
        time[-1] >= length * (1.0 - 1e-9),
        f"wind.file: {file} holds {time[-1]:g} s, but record.duration asks for {length + step:g} s",
    )
    at = step * np.arange(steps)
    return np.stack([np.interp(at, time, found.values[name]) for name in NAMES], axis=1)
