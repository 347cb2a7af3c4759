"""Find the frequency up to which the motion in recorded positions stands out from their noise."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.recorded.gridding import FULL_BAND, make_uniform
from owtsweep.motion.recorded.recording import Recording

#: Samples of a segment, and the most segments, of which the spectrum is the mean.
SEGMENT, MOST_SEGMENTS = 512, 400
#: The motion stands out where the density is this many times that of the noise.
CLEAR = 4.0


def find_clear_band(recording: Recording, roles: Sequence[str], lowest: float) -> float:
    """Return the frequency (Hz) above `lowest` up to which positions are mostly motion.

    The noise is taken as white: its density is the median density above 0.4 of the sampling rate.
    The result is at most 0.4 of the lowest sampling rate, and `lowest` if the record has fewer than
    512 samples.

    Parameters
    ----------
    recording
        A checked recording.
    roles
        The channels with the positions, e.g. "reference_x" and "reference_y". The result is that of
        the channel with the widest band.
    lowest
        Frequency in Hz at which the search begins.
    """
    found = lowest
    for role in roles:
        (_, values), step, _ = make_uniform(recording, role)
        if FULL_BAND / step <= lowest or len(values) < SEGMENT:
            continue
        frequency, density = estimate_density(values, step)
        noise = np.median(density[frequency > FULL_BAND / step])
        kept = (frequency > lowest) & (frequency <= FULL_BAND / step)
        drowned = np.flatnonzero(kept & (density <= CLEAR * noise))
        clear = frequency[drowned[0] - 1] if len(drowned) else FULL_BAND / step
        found = max(found, clear)
    return float(found)


def estimate_density(values: Array, step: float) -> tuple[Array, Array]:
    """Estimate a spectral density by Welch's method; return frequencies (Hz) and densities.

    `values` has the shape (n,), n at least 512; `step` is the sampling interval in s. Segments
    overlap by half or less and have a Hann window; their mean and trend are removed.
    """
    most = len(values) - SEGMENT
    starts = np.unique(
        np.linspace(0, most, min(2 * most // SEGMENT + 1, MOST_SEGMENTS)).astype(int)
    )
    segments = np.stack([values[start : start + SEGMENT] for start in starts])
    line = np.linspace(-1.0, 1.0, SEGMENT)
    segments -= segments.mean(axis=1, keepdims=True)
    segments -= np.outer(segments @ line / (line @ line), line)
    window = np.hanning(SEGMENT)
    power = np.mean(np.abs(np.fft.rfft(segments * window, axis=1)) ** 2, axis=0)
    return np.fft.rfftfreq(SEGMENT, step), 2.0 * step * power / np.sum(window**2)
