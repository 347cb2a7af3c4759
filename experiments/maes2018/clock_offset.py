"""Offset of two clocks by the correlation of what both systems saw.

Maes et al. (2018), section 2.1, synchronise total stations, about 1 Hz and irregular, with the
time stamps of GPS "manually, by correlating the altitude" of both systems. Here this is a search:
the offset is that of the largest correlation coefficient.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array


def find_offset(
    dense_times: Array, dense_signal: Array, times: Array, values: Array, most: float
) -> float:
    """Return by how much the clock of the sparser record is ahead of the denser record's, s.

    What the denser record stamps t, the sparser stamps t + offset; subtracting the offset from the
    sparser's time stamps brings them to the denser's clock. It is negative if they are early.

    The denser record is smoothed over 1 interval of the sparser to both sides and interpolated at
    the sparser's times, shifted. Without smoothing, its noise makes the correlation rough from one
    sample to the next, and the largest value is found by chance. The two signals may differ by a
    factor, if positive, and a constant. Of motions with one period, offsets a period apart look
    alike; `most` below half a period tells them apart.

    Parameters
    ----------
    dense_times, times
        Time stamps, s, increasing, not necessarily regular, shapes (n,) and (m,).
    dense_signal, values
        The same motion seen by both, shapes (n,) and (m,).
    most
        Largest offset searched to both sides, s. What comes out at this limit is no optimum: the
        true offset may be beyond it.
    """
    step, window = (float(np.median(np.diff(stamps))) for stamps in (dense_times, times))
    grid, smoothed = smooth(dense_times, dense_signal, step, window)
    # The same samples at all offsets: otherwise coefficients of different motions are compared.
    both = (times - most >= grid[0]) & (times + most <= grid[-1])
    return -find_shift(times[both], values[both], grid, smoothed, step, most)


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
    smoothed = np.convolve(np.interp(grid, times, values), weights / weights.sum(), mode="valid")
    return grid[half:-half], smoothed
