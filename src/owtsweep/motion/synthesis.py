"""Random-phase realisations of a motion spectrum, with consistent derivatives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.motion.spectra import Spectrum
from owtsweep.paging import fill

NORMALISATIONS = ("peak", "rms")
#: Longest records (2621 s at 100 Hz) whose three series are transformed side by side: that takes
#: two thirds of the time and three times the memory, for the same bits.
MOST_TOGETHER = 2**18
#: Samples and records that `displacements` transforms together at most.
SAMPLES_TOGETHER, RECORDS_TOGETHER = 500_000, 8


@dataclass(frozen=True)
class Motion:
    """Displacement along one direction, with what a delayed measurement still reports.

    Attributes
    ----------
    step
        Sampling interval, s.
    position, velocity, acceleration
        (steps,) in m, m/s, m/s^2, from t = 0.
    before
        (history,) positions before t = 0, oldest first, m.
    """

    step: float
    position: Array
    velocity: Array
    acceleration: Array
    before: Array

    def position_at(self, first: int, stride: int, count: int) -> Array:
        """(count,) positions at steps first, first + stride, ...; `first` may reach into the past.

        Raises
        ------
        ValueError
            If the record does not reach that far back.
        """
        if first < -len(self.before):
            raise ValueError(
                f"the record holds {len(self.before)} steps before t = 0, not {-first}"
            )
        earlier = min(max(-(first // stride), 0), count)  # how many of them lie in the past
        past = self.before[first + len(self.before) :: stride][:earlier]
        return np.concatenate([past, self.position[first + earlier * stride :: stride]])[:count]


def lines(band: tuple[float, float], period: float) -> tuple[NDArray[np.int64], Array]:
    """Numbers m and frequencies m / period (Hz) of the lines inside the band, edges included.

    Raises
    ------
    InputError
        If there is none.
    """
    first = int(np.ceil(band[0] * period - 1e-9))
    last = int(np.floor(band[1] * period + 1e-9))
    numbers = np.arange(max(first, 1), last + 1)
    if len(numbers) == 0:
        raise InputError(
            f"band: [{band[0]:g}, {band[1]:g}] Hz holds no line of a record that is "
            f"{period / 2:g} s long; widen it or lengthen record.duration"
        )
    return numbers, numbers / period


def synthesise(
    spectrum: Spectrum,
    phase: np.random.Generator,
    *,
    steps: int,
    step: float,
    band: tuple[float, float],
    normalise: str = "peak",
    history: int = 0,
    out: Array | None = None,
) -> Motion:
    """Draw one record of a spectrum.

    Lines at f_m = m / (2 duration) inside the band carry the amplitude sqrt(2 S(f_m) df) and a
    uniform random phase; position, velocity and acceleration are one inverse FFT each. The first
    half of the FFT's period is the record, so nothing repeats inside it; what stands before t = 0
    is the end of the second half.

    Parameters
    ----------
    spectrum
        Shape of the spectrum.
    phase
        Stream of the phases. Line m always takes the m-th number, so moving a band edge leaves
        the phases of the lines that stay.
    steps, step
        Number of samples and sampling interval (s); the duration is their product.
    band
        Lower and upper edge, Hz.
    normalise
        "peak": the largest |d| of the record is 1 m; "rms": its standard deviation is 1 m.
    history
        How many steps before t = 0 to keep.
    out
        (3, steps) to put position, velocity and acceleration into.
    """
    numbers, frequency, amplitude = _lines(spectrum, steps, step, band)
    line = _drawn(phase, numbers, amplitude, steps)
    result = np.empty((3, steps)) if out is None else out
    omega = 2.0 * np.pi * frequency
    bins = np.zeros((3, numbers[-1] + 1), dtype=complex)
    bins[0, numbers] = line * 1.0
    bins[1, numbers] = line * (1j * omega)
    bins[2, numbers] = line * (-(omega**2) + 0j)
    series = _transformed(bins, 2 * steps)
    position = next(series)
    record = position[:steps]
    if normalise == "peak":
        scale = 1.0 / np.max(np.abs(record))
    elif normalise == "rms":
        scale = 1.0 / np.std(record)
    else:
        raise InputError(f"normalise: {normalise!r} is none of {', '.join(NORMALISATIONS)}")
    before = scale * position[2 * steps - history :]
    fill(result[0], record, scale)
    del position, record
    for row in (1, 2):
        fill(result[row], next(series)[:steps], scale)
    return Motion(step, result[0], result[1], result[2], before)


def displacements(
    spectrum: Spectrum,
    phases: Sequence[np.random.Generator],
    *,
    steps: int,
    step: float,
    band: tuple[float, float],
) -> Iterator[Array]:
    """The displacement alone of what `synthesise` draws of each stream, (steps,) in m, not scaled.

    Several records share a transform, which then works on some at once, for the same bits.
    """
    numbers, _, amplitude = _lines(spectrum, steps, step, band)
    count = min(max(SAMPLES_TOGETHER // steps, 1), RECORDS_TOGETHER)
    bins = np.zeros((count, steps + 1), dtype=complex)
    for first in range(0, len(phases), count):
        some = phases[first : first + count]
        for row, phase in zip(bins, some, strict=False):
            row[numbers] = _drawn(phase, numbers, amplitude, steps)
        for position in _transformed(bins[: len(some)], 2 * steps):
            yield position[:steps]


def _lines(
    spectrum: Spectrum, steps: int, step: float, band: tuple[float, float]
) -> tuple[NDArray[np.int64], Array, Array]:
    """Numbers, frequencies (Hz) and amplitudes (m) of a record's lines."""
    period = 2 * steps * step
    numbers, frequency = lines(band, period)
    return numbers, frequency, np.sqrt(2.0 * spectrum.density(frequency) / period)


def _drawn(
    phase: np.random.Generator, numbers: NDArray[np.int64], amplitude: Array, steps: int
) -> NDArray[np.complex128]:
    """The lines with random phases, as `irfft` takes them: it divides by 2 steps."""
    phases = 2.0 * np.pi * phase.random(numbers[-1] + 1)[numbers]
    drawn: NDArray[np.complex128] = amplitude * np.exp(1j * phases) * steps  # a cosine is half
    return drawn


def _transformed(bins: NDArray[np.complex128], samples: int) -> Iterator[Array]:
    """The inverse real Fourier transforms of some rows, each `samples` long, one after the other.

    The rows may be shorter: bins beyond their end are zero.
    """
    if samples <= 2 * MOST_TOGETHER:
        from scipy.fft import irfft

        yield from irfft(bins, n=samples)
    else:
        for row in bins:  # numpy's, not scipy's, which would make a longer copy of the row
            yield np.asarray(np.fft.irfft(row, n=samples))
