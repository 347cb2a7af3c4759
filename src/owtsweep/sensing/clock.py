"""A sensor with a wrong clock: its time stamps differ from the true times of measurement."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError


@dataclass(frozen=True)
class Clock:
    """A clock with an offset and a drift relative to true time.

    A sample that carries the time t was taken at the true time t + offset + drift t.

    Attributes
    ----------
    offset
        At t = 0, s; negative if samples are older than their time stamps.
    drift
        Seconds per second.

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
        """The values that the sensor reports at given times on its clock.

        Values between samples come from a spline of degree 5. Its error falls with the sixth power
        of the step: it is below 1e-9 of an oscillation that has 100 samples per period.

        Parameters
        ----------
        values
            (samples,) or (samples, axes): the truth at start, start + step, ...
        start, step
            In s, on the true clock.
        stamped
            (n,) times on the sensor's clock, s.

        Returns
        -------
        Array
            (n,) or (n, axes).

        Raises
        ------
        InputError
            If an instant lies outside the samples. The message says by how much.
        """
        from scipy.interpolate import make_interp_spline

        time = start + step * np.arange(len(values))
        instants = stamped + self.offset + self.drift * stamped
        missing = max(start - float(np.min(instants)), float(np.max(instants)) - float(time[-1]))
        if missing > 1e-9 * step:
            raise InputError(
                f"clock: samples are taken up to {missing:.4g} s outside the motion; lengthen it "
                "at both ends by what offset and drift come to"
            )
        inside = np.clip(instants, start, time[-1])
        return np.asarray(make_interp_spline(time, values, k=5)(inside))
