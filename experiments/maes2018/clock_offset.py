"""Offset of two clocks by the correlation of what both systems saw.

Maes et al. (2018), section 2.1, synchronise total stations, about 1 Hz and irregular, with the
time stamps of GPS "manually, by correlating the altitude" of both systems. Here this is a search:
the offset is that of the largest correlation coefficient.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError, require

#: Fewest samples of the sparser record that must lie within the other at all offsets searched.
FEWEST = 10


def find_offset(
    first_times: Array,
    first_signal: Array,
    second_times: Array,
    second_signal: Array,
    most: float,
) -> float:
    """Return by how much the second clock is ahead of the first, s.

    What the first record stamps t, the second stamps t + offset; subtracting the offset from the
    second's time stamps brings them to the first's clock. It is negative if the second's stamps are
    early.

    The denser record is smoothed over 1 interval of the sparser to both sides and interpolated at
    the sparser's times, shifted. Without smoothing, its noise makes the correlation rough from one
    sample to the next, and the largest value is found by chance. The two signals may differ by a
    factor, if positive, and a constant. Of motions with one period, offsets a period apart look
    alike; `most` below half a period tells them apart.

    Parameters
    ----------
    first_times, second_times
        Time stamps, s, increasing, not necessarily regular, shapes (n,) and (m,).
    first_signal, second_signal
        The same motion seen by both, shapes (n,) and (m,). Samples of NaN are left out.
    most
        Largest offset searched to both sides, s. What comes out at this limit is no optimum: the
        true offset may be beyond it.

    Raises
    ------
    InputError
        If time stamps go back, a signal does not move, or the records have too little in common.
    """
    require(
        bool(np.isfinite(most)) and most > 0.0,
        f"most: {most:g} s leaves nothing to search; a positive offset would work",
    )
    first = keep_known("first", first_times, first_signal)
    second = keep_known("second", second_times, second_signal)
    intervals = [float(np.median(np.diff(times))) for times, _ in (first, second)]
    is_second_dense = intervals[1] <= intervals[0]
    (times, values), dense = (first, second) if is_second_dense else (second, first)
    step, window = min(intervals), max(intervals)

    grid, smoothed = smooth(*dense, step, window)
    # The same samples at all offsets: otherwise coefficients of different motions are compared.
    both = (times - most >= grid[0]) & (times + most <= grid[-1])
    require(
        int(both.sum()) >= FEWEST,
        f"most: only {int(both.sum())} samples of the sparser record lie in the other at all "
        f"offsets of {most:g} s to both sides; longer records or fewer seconds would work",
    )
    require(
        float(np.ptp(values[both])) > 0.0,
        "signal: the sparser record does not move where both records are; "
        "a part with motion would work",
    )
    shift = find_shift(times[both], values[both], grid, smoothed, step, most)
    return shift if is_second_dense else -shift


def find_shift(
    times: Array, values: Array, grid: Array, smoothed: Array, step: float, most: float
) -> float:
    """Return the shift of `times`, s, at which the values on the grid correlate best with `values`.

    All shifts up to `most` are tried in steps of at most `step`, then the best is refined.
    """
    from scipy.interpolate import make_interp_spline
    from scipy.optimize import minimize_scalar

    spline = make_interp_spline(grid, smoothed, k=3)
    centred = values - values.mean()

    def lack(shift: float) -> float:
        seen = spline(times + shift)
        seen = seen - seen.mean()
        size = np.sqrt((centred @ centred) * (seen @ seen))
        return 1.0 - float(centred @ seen / size) if size > 0.0 else 1.0

    shifts = np.linspace(-most, most, 2 * int(np.ceil(most / step)) + 1)
    best = int(np.argmin([lack(shift) for shift in shifts]))
    around = shifts[max(best - 1, 0)], shifts[min(best + 1, len(shifts) - 1)]
    found = minimize_scalar(lack, bounds=around, method="bounded", options={"xatol": 1e-6})
    return float(found.x if found.fun < lack(shifts[best]) else shifts[best])


def smooth(times: Array, values: Array, step: float, window: float) -> tuple[Array, Array]:
    """Return regular times and values smoothed by a Hann window `window` s to both sides.

    Values at the ends, where the window is not full, are cut off.
    """
    grid = times[0] + step * np.arange(int((times[-1] - times[0]) / step) + 1)
    half = max(int(window / step), 1)
    weights = np.hanning(2 * half + 3)[1:-1]
    require(
        len(grid) >= len(weights) + 3,
        f"times: the denser record lasts {times[-1] - times[0]:g} s, too little to smooth; "
        f"more than {4.0 * window:.3g} s would work",
    )
    smoothed = np.convolve(np.interp(grid, times, values), weights / weights.sum(), mode="valid")
    return grid[half:-half], smoothed


def keep_known(name: str, times: Array, signal: Array) -> tuple[Array, Array]:
    """Return the times and values of samples that are not NaN.

    Raises
    ------
    InputError
        As of `find_offset`.
    """
    require(
        times.ndim == 1 and signal.shape == times.shape,
        f"{name}_signal: has shape {signal.shape} at times of {times.shape}; one value for each "
        "time would work",
    )
    require(
        bool(np.isfinite(times).all()) and bool(np.all(np.diff(times) > 0.0)),
        f"{name}_times: go back, repeat or have a NaN; increasing numbers would work",
    )
    known = np.isfinite(signal)
    if int(known.sum()) < FEWEST:
        raise InputError(
            f"{name}_signal: has {int(known.sum())} known samples; {FEWEST} and more would work"
        )
    require(
        float(np.ptp(signal[known])) > 0.0,
        f"{name}_signal: does not move, so nothing correlates; a part with motion would work",
    )
    return times[known], signal[known]
