"""Models a sensor's wrong clock, whose time stamps differ from the true times of measurement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError


@dataclass(frozen=True)
class Clock:
    """A clock with an offset and a drift relative to true time.

    A sample with the time stamp t was taken at the true time t + offset + drift t.

    Attributes
    ----------
    offset
        Offset at t = 0, s; negative if samples are older than their time stamps.
    drift
        Growth of the offset, in seconds per second.

    Raises
    ------
    InputError
        If the clock stands still or runs backwards.
    """

    offset: float = 0.0
    drift: float = 0.0

    def __post_init__(self) -> None:
        if not self.drift > -1.0:
            raise InputError(f"drift: {self.drift:g} s/s stops the clock; give more than -1")

    def read(self, values: Array, *, start: float, step: float, stamped: Array) -> Array:
        """Return the values that the sensor reports at given times on its clock.

        Values between samples come from a spline of degree 5. The spline's error falls with the
        sixth power of the sampling interval. For an oscillation with 100 samples per period the
        error is below 1e-9 of the oscillation's amplitude.

        Parameters
        ----------
        values
            True values at the times start, start + step, ..., shape (samples,) or (samples, axes).
        start, step
            True time of the first sample, and sampling interval, s.
        stamped
            Times on the sensor's clock, s, shape (n,).

        Returns
        -------
        Array
            The values, shape (n,) or (n, axes).

        Raises
        ------
        InputError
            If a true time of measurement is before the first sample or after the last. The message
            says by how much.
        """
        from scipy.interpolate import make_interp_spline

        time = start + step * np.arange(len(values))
        instants = stamped + self.offset + self.drift * stamped
        missing = max(start - float(np.min(instants)), float(np.max(instants)) - float(time[-1]))
        if missing > 1e-9 * step:
            raise InputError(
                f"clock: samples are taken up to {missing:.4g} s outside the motion; lengthen it "
                f"by {missing:.4g} s at both ends, or give a smaller offset and drift"
            )
        inside = np.clip(instants, start, time[-1])
        return np.asarray(make_interp_spline(time, values, k=5)(inside))
