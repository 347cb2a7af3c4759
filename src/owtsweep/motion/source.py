"""Sources of motion: what one is, and the source that draws records of a spectrum.

Other sources are recorded files, and structures under waves. The spectrum of Ren et al. (2019) is
S(f) = a f / (f^2 + b f + c), Eq. (1). Its peak lies at f* = sqrt(c), Eq. (2). The denominator must
be positive for every f > 0. This holds if, and only if, 2 sqrt(c) + b > 0. (At the peak, the
denominator is f* (2 sqrt(c) + b).)
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import ClassVar, Literal, Protocol

import numpy as np
from numpy.typing import NDArray

from owtsweep.arrays import Array
from owtsweep.errors import InputError
from owtsweep.streams import Streams


@dataclass(frozen=True)
class Motion:
    """One realisation of a motion, with positions before t = 0, which delayed sensors report.

    step: Sampling interval, s.
    position, velocity, acceleration: Series from t = 0 on, in m, m/s and m/s^2. Shape (steps,) for
        a motion along one direction, (steps, axes) for a motion along several axes.
    before: Positions before t = 0, oldest first, m; shape (history,) or (history, axes).
    felt: What an accelerometer on the structure feels of this motion, m/s^2, if that is more than
        the acceleration, because the structure leans; shape as `acceleration`, or None.
    """

    step: float
    position: Array
    velocity: Array
    acceleration: Array
    before: Array
    felt: Array | None = None

    @property
    def specific_force(self) -> Array:
        """What an accelerometer feels of the motion, m/s^2, in the shape of `acceleration`."""
        return self.acceleration if self.felt is None else self.felt

    def position_at(self, first: int, stride: int, count: int) -> Array:
        """Return `count` positions, at the steps first, first + stride, first + 2 stride, ...

        Steps are counted from t = 0; `first` may be negative. The result has shape (count,) or
        (count, axes); it is shorter if the record ends earlier. Raise `ValueError` if the record
        begins after the step `first`.
        """
        if first < -len(self.before):
            raise ValueError(
                f"the record holds {len(self.before)} steps before t = 0, not {-first}"
            )
        past = self.before[first + len(self.before) :: stride]
        return np.concatenate([past, self.position[first + len(past) * stride :: stride]])[:count]


class Source(Protocol):
    """The interface of a source of motion, such as a spectrum or a recorded file.

    All randomness of a realisation comes from the named random streams that `realise` is given.
    Therefore, two realisations with the same streams are equal bit by bit.

    streams: names of the random streams that the source draws from. If there are no names, all
        realisations are equal.
    duration: Duration in s of the longest record that the source can give, including the time
        before t = 0; None if the duration has no bound.
    """

    @property
    def streams(self) -> tuple[str, ...]: ...

    @property
    def duration(self) -> float | None: ...

    def realise(self, stream: Streams, *, steps: int, step: float, history: int = 0) -> Motion:
        """Return one realisation of the motion.

        Raise `InputError` if the source cannot give a record of this length; the message says what
        would work.

        stream: function that returns a new random generator, given the name of a random stream.
        steps, step: Number of samples and sampling interval (s) of the motion.
        history: Number of steps before t = 0 for which positions are needed: the longest delay of a
            sensor.
        """


@dataclass(frozen=True)
class DerivedSource:
    """A source of motion that is made of another: it has its random streams and its duration."""

    source: Source

    @property
    def streams(self) -> tuple[str, ...]:
        return self.source.streams

    @property
    def duration(self) -> float | None:
        return self.source.duration


#: Half-bandwidth squared, s^-2. With this value `translated`, once rounded, gives all 12 printed
#: values of b and c.
TABLE_4_BANDWIDTH = 2.4e-4

#: Coefficient a divided by the natural period T, s^-1: the mean over Table 4.
AMPLITUDE_PER_PERIOD = 0.4611e-6

#: Table 4 of the paper: natural period (s) -> a, b, c.
TABLE_4 = {
    3.0: (1.37e-06, -0.67, 0.11),
    4.0: (1.83e-06, -0.50, 0.062),
    5.0: (2.32e-06, -0.40, 0.040),
    6.0: (2.81e-06, -0.33, 0.028),
    7.0: (3.23e-06, -0.28, 0.020),
    8.0: (3.67e-06, -0.25, 0.016),
}


@dataclass(frozen=True)
class Spectrum:
    """The one-sided spectrum S(f) = a f / (f^2 + b f + c), Eq. (1), for f in Hz and S in m^2/Hz.

    A record that is scaled to a given peak or rms does not depend on the coefficient a.
    """

    a: float
    b: float
    c: float

    @property
    def peak_frequency(self) -> float:
        """The frequency of the peak, f* = sqrt(c), in Hz; Eq. (2)."""
        return float(np.sqrt(self.c))

    @property
    def peak_margin(self) -> float:
        """The value 2 sqrt(c) + b in Hz; the peak is finite if this value is positive.

        The height of the peak is a / (2 sqrt(c) + b). The text below Eq. (2) of Ren et al. (2019)
        prints a / (2 sqrt(c + b)) by mistake.
        """
        return 2.0 * self.peak_frequency + self.b

    def density(self, frequency: Array) -> Array:
        """Compute the spectral density S(f) in m^2/Hz at frequencies in Hz, Eq. (1)."""
        return self.a * frequency / (frequency**2 + self.b * frequency + self.c)


def translated(natural_period: float, bandwidth: float = TABLE_4_BANDWIDTH) -> Spectrum:
    """Return a spectrum of fixed half-bandwidth with its peak at 1 / natural_period.

    Section 2.2 of Ren et al. (2019) describes the spectra of Table 4 in this way: as one peak that
    is shifted along the frequency axis. With the natural period T (s), a constant k, a = 0.4611e-6
    T, b = -2/T + k T and c = 1/T^2, the denominator of Eq. (1) is (f - 1/T)^2 + k T f. The peak is
    at 1/T, and its half-bandwidth is sqrt(k) for every T. `bandwidth` is k in s^-2; 6.7e-6
    corresponds to 1 % damping.
    """
    T = natural_period
    return Spectrum(a=AMPLITUDE_PER_PERIOD * T, b=-2.0 / T + bandwidth * T, c=1.0 / T**2)


def printed(natural_period: float) -> Spectrum:
    """Return the spectrum with the coefficients that Table 4 of Ren et al. (2019) prints.

    Raise `InputError` for a natural period (s) that is not in the table, and for 3, 4 and 5 s: with
    b and c rounded to two digits as printed, the spectrum has no finite peak at these periods.
    """
    row = TABLE_4.get(float(natural_period))
    if row is None:
        periods = ", ".join(f"{period:g}" for period in TABLE_4)
        raise InputError(
            f"spectrum=printed: the paper's Table 4 has no natural period {natural_period:g} s, "
            f"only {periods} s: use spectrum=translated"
        )
    spectrum = Spectrum(*row)
    if spectrum.peak_margin <= 1e-12:
        raise InputError(
            f"spectrum=printed has no finite peak at {natural_period:g} s (2 sqrt(c) + b = "
            f"{spectrum.peak_margin:.2g}): use spectrum=translated, or "
            "grid.natural_period=[6,7,8]"
        )
    return spectrum


#: Least length of a short transform divided by the number of the last line. A larger value makes
#: the transforms longer; a smaller one needs more factors to multiply the lines with.
SHORT = 8
#: Least length of a short transform, samples: for a shorter one the call takes most of the time.
LEAST = 1024
#: Number of transforms in one call: SIDE_BY_SIDE, but at most a quarter of all, to limit memory. If
#: transforms are short, more are made in one call, with TOGETHER samples in total.
SIDE_BY_SIDE, TOGETHER = 4, 2**16
#: Longer transforms are made by NumPy: for a length with large prime factors, SciPy keeps some
#: hundred bytes per sample until the process ends.
LONG = 2**19

#: What of a record's displacement is 1 m: its largest value, or its standard deviation.
Normalise = Literal["peak", "rms"]


class Density(Protocol):
    """A spectrum as far as records need it."""

    def density(self, frequency: Array) -> Array:
        """Compute the spectral density, m^2/Hz, at frequencies in Hz."""


def interleaved(bins: NDArray[np.complex128], samples: int) -> Array:
    """Compute Re sum_m bins[m] exp(2 pi i m n / samples) for n = 0, ..., samples - 1.

    One long Fourier transform is split into L short ones. The samples n = r, r + L, r + 2 L, ...
    are a transform of length samples / L of bins[m] exp(2 pi i m r / samples). Short transforms fit
    into the processor's caches, run side by side, and need few zeros as padding. Source: Sorensen
    and Burrus (1993), "Efficient computation of the DFT with only a subset of input or output
    points", IEEE Trans. Signal Process. 41(3).

    `bins` has the shape (last + 1,), with bins[0] = 0 and 2 last < samples; `samples` is even. The
    result has the shape (L, samples / L), where samples / L is even: sample L j + r is in row r,
    column j.
    """
    from scipy.fft import irfft

    length = _short_length(len(bins) - 1, samples)
    turns = _turns(len(bins), samples, length)
    transform = irfft if length <= LONG else np.fft.irfft
    rows = np.empty((len(turns), length))
    count = max(min(len(turns) // 4, SIDE_BY_SIDE), TOGETHER // length, 1)
    # padded once here; otherwise each transform would copy them into longer arrays
    padded = np.zeros((min(count, len(turns)), length // 2 + 1), dtype=complex)
    for first in range(0, len(turns), count):
        some_turns = turns[first : first + count]
        some = padded[: len(some_turns)]
        np.multiply(bins, some_turns, out=some[:, : len(bins)])
        rows[first : first + count] = transform(some, n=length, axis=1)
    return rows


@lru_cache
def _short_length(last: int, samples: int) -> int:
    """Choose the length of the short transforms into which one of `samples` samples is split.

    It is the least even divisor of `samples` that is at least `LEAST` and at least `SHORT` times
    the number of the last line, or else `samples`.
    """
    for count in range(samples // max(SHORT * last, LEAST), 1, -1):
        if samples % (2 * count) == 0:
            return samples // count
    return samples


@lru_cache(maxsize=2)
def _turns(bins: int, samples: int, length: int) -> NDArray[np.complex128]:
    """Compute exp(2 pi i m r / samples) length / 2 of bin m in short transform r.

    The shape is (samples / length, bins).
    """
    numbers, first = np.arange(bins), np.arange(samples // length)
    # the exact product modulo a whole turn: a large angle would lose its last digits
    angle = 2.0 * np.pi / samples * (first[:, None] * numbers % samples)
    # irfft divides by its length, and a cosine is half of a pair
    turns: NDArray[np.complex128] = np.exp(1j * angle) * (length / 2)
    turns.setflags(write=False)
    return turns


def lines(band: tuple[float, float], period: float) -> tuple[NDArray[np.int64], Array]:
    """Return the numbers m and the frequencies m / period (Hz) of the lines inside a band.

    The edges of the band, which are inside, are in Hz; `period` is in s. Raise `InputError` if
    there are no lines in the band.
    """
    inside = line_numbers(band, period)
    numbers = np.arange(inside.start, inside.stop)
    return numbers, numbers / period


def line_numbers(band: tuple[float, float], period: float) -> range:
    """Return the numbers that `lines` returns as a range, which takes no memory.

    Raise `InputError` if there are no lines in the band.
    """
    first = int(np.ceil(band[0] * period - 1e-9))
    last = int(np.floor(band[1] * period + 1e-9))
    numbers = range(max(first, 1), last + 1)
    if not numbers:
        raise InputError(
            f"band: [{band[0]:g}, {band[1]:g}] Hz holds no line of a record that is "
            f"{period / 2:g} s long; widen the band or lengthen record.duration"
        )
    return numbers


def find_size(position: Array, normalise: Normalise) -> float:
    """Return the largest displacement ("peak"), up to its sign, or the standard deviation ("rms").

    `position` is in m, and may have any shape.
    """
    if normalise == "peak":
        return float(max(np.max(position), -np.min(position)))
    return float(np.std(position))


@dataclass(frozen=True)
class SpectralSource:
    """A source of motion along one direction: records of a spectrum with random phases.

    Spectral lines at f_m = m df, df = 1 / (2 duration), inside the band have the amplitude sqrt(2
    S(f_m) df) and a uniform random phase. Position, velocity and acceleration are one inverse
    Fourier transform each (`interleaved`). The first half of the transform's period is the record,
    so nothing repeats inside the record. The positions before t = 0 are the end of the second half.

    Line m always takes the random number of index m. So moving an edge of the band does not change
    the phases of lines that stay inside.

    spectrum: Only its shape matters to a record, because it is normalised.
    band: Lower and upper edge of the band, Hz.
    normalise: "peak": the largest displacement in the record is 1 m, up to its sign. "rms": the
        standard deviation of the displacement is 1 m.
    """

    spectrum: Density
    band: tuple[float, float]
    normalise: Normalise = "peak"
    streams: ClassVar[tuple[str, ...]] = ("phase",)
    duration: ClassVar[None] = None

    def realise(self, stream: Streams, *, steps: int, step: float, history: int = 0) -> Motion:
        """Draw one record of any length, as `Source.realise` says; the stream is "phase".

        Raise `InputError` if no spectral line lies in the band.
        """
        numbers, frequency, line = self._draw_lines(stream("phase"), steps, step)
        result = np.empty((3, steps))
        omega = 2.0 * np.pi * frequency
        whole = _sampled(numbers, line, steps)
        record = _first_half(whole)
        scale = 1.0 / find_size(record, self.normalise)
        before = scale * _newest(whole, history)
        _put(record, scale, result[0])
        for row, factor in ((1, 1j * omega), (2, -(omega**2))):
            del record, whole  # frees the memory of a long record before the next is made
            whole = _sampled(numbers, line * factor, steps)
            record = _first_half(whole)
            _put(record, scale, result[row])
        return Motion(step, result[0], result[1], result[2], before)

    def draw_displacement(self, phase: np.random.Generator, steps: int, step: float) -> Array:
        """Draw the displacement of a record, not normalised, in m, shape (steps,).

        `realise`, given the same random numbers, draws the same, multiplied by a factor. Raise
        `InputError` if no line lies in the band.
        """
        numbers, _, line = self._draw_lines(phase, steps, step)
        return _first_half(_sampled(numbers, line, steps)).T.reshape(-1)

    def _draw_lines(
        self, phase: np.random.Generator, steps: int, step: float
    ) -> tuple[NDArray[np.int64], Array, NDArray[np.complex128]]:
        """Draw the lines of a record: numbers, frequencies (Hz), complex amplitudes (m)."""
        period = 2 * steps * step
        numbers, frequency = lines(self.band, period)
        amplitude = np.sqrt(2.0 * self.spectrum.density(frequency) / period)
        phases = 2.0 * np.pi * phase.random(numbers[-1] + 1)[numbers]
        return numbers, frequency, amplitude * np.exp(1j * phases)


def _sampled(numbers: NDArray[np.int64], line: NDArray[np.complex128], steps: int) -> Array:
    """Compute the 2 * steps samples of a whole period, arranged as by `interleaved`."""
    bins = np.zeros(numbers[-1] + 1, dtype=complex)
    bins[numbers] = line
    return interleaved(bins, 2 * steps)


def _first_half(whole: Array) -> Array:
    """Return the first half of the samples of a period, arranged as by `interleaved`."""
    return whole[:, : whole.shape[1] // 2]


def _newest(whole: Array, count: int) -> Array:
    """Return the last `count` samples of a period, in order of time."""
    columns = -(-count // len(whole))
    some = whole[:, whole.shape[1] - columns :].T.reshape(-1)
    return some[len(some) - count :]


def _put(rows: Array, scale: float, out: Array) -> None:
    """Write samples, arranged as by `interleaved`, times `scale` to `out`, in order of time."""
    np.multiply(rows.T, scale, out=out.reshape(rows.T.shape))
