"""Finds how the specific force leans with displacement, by comparing it with fixes in the band.

The specific force of a swing at the angular frequency w is -(w^2 + lean) times its displacement.
Both are measured: the force by the IMU, the displacement by fixes, whose delay is known. So `lean`
follows from the ordinates of their Fourier transforms at which the force stands out of the fixes'
noise, with the force as instrument. It is rounded to steps, and moves only where the scatter of the
ordinates shows that it must.
"""

from __future__ import annotations

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.candidates import HANN, HANN_SQUARE, transform

#: Step of the lean, s^-2: .001 rad/m of tilt.
STEP = 0.01
#: Times that are compared, s; the longest one that has passed is used.
TIMES = (60.0, 120.0, 240.0)
#: By how many standard deviations another lean must be nearer, the fewest ordinates, and the least
#: power of an ordinate of the displacement, by the force, per power of the fixes' noise.
SURE, FEWEST, CLEAR = 5.0, 8, 50.0


class LeanTracker:
    """Estimates the lean of the specific force along an axis.

    steps: sampling interval of the averaged force, and time between fixes, s.
    delay: age of the position that a fix reports, s.
    sigma: standard deviation of a fix's white noise, m.
    band: edges of the band of the motion, Hz.
    lean: the lean to begin with, s^-2.
    """

    def __init__(
        self,
        steps: tuple[float, float],
        delay: float,
        sigma: float,
        band: tuple[float, float],
        lean: float,
    ) -> None:
        self._steps, self._delay, self._sigma = steps, delay, sigma
        # above, motion of the band's upper part is folded back
        self._band = band[0], min(band[1], 1.0 / steps[1] - band[1])
        #: The lean that is chosen, s^-2.
        self.chosen = lean

    def look(self, force: Array, fixes: Array) -> float:
        """Estimate the lean from the averaged force (n,) and the fixes (m,) up to now.

        Fixes are m; the last one is a fix interval old. Those before a lost one (NaN) do not count.
        """
        lost = np.flatnonzero(np.isnan(fixes))
        count = len(fixes) - (lost[-1] + 1 if len(lost) else 0)
        passed = min(count * self._steps[1], len(force) * self._steps[0]) + 1e-9
        times = [time for time in TIMES if time <= passed]
        if not times:
            return self.chosen
        found = self._compare(force, fixes, times[-1])
        if found is not None:
            lean, sigma = found
            nearest = STEP * round((lean - self.chosen) / STEP)
            if abs(nearest) >= STEP and abs(lean - self.chosen) > SURE * sigma:
                self.chosen += nearest
        return self.chosen

    def _compare(self, force: Array, fixes: Array, time: float) -> tuple[float, float] | None:
        """Return the lean, s^-2, and its standard deviation; None if the motion is too small."""
        counts = [round(time / step) for step in self._steps]
        frequency = np.fft.rfftfreq(counts[0], self._steps[0])
        # the middle of a block of samples is half a block after its beginning
        of_force = transform(force[-counts[0] :], self._steps[0], 0.5 * self._steps[0])
        of_fixes = transform(fixes[-counts[1] :], self._steps[1], -self._delay)
        low, high = np.searchsorted(frequency, self._band)
        inside = slice(int(low), min(int(high), len(of_fixes)))
        omega = 2.0 * np.pi * frequency[inside]
        F, X = of_force[inside], of_fixes[inside]
        noise = self._sigma**2 * self._steps[1] * time * HANN_SQUARE
        clear = np.abs(F) ** 2 > CLEAR * noise * omega**4
        if np.count_nonzero(clear) < FEWEST:
            return None
        omega, F, X = omega[clear], F[clear], X[clear]
        missing = -(F + omega**2 * X)
        # the force as instrument: noise of fixes, and outliers, do not bias the lean
        common = float(np.sum((np.conj(F) * X).real))
        lean = float(np.sum((np.conj(F) * missing).real)) / common
        rest = np.abs(missing - lean * X) ** 2
        variance = HANN * np.sum(rest * np.abs(F) ** 2) / (2.0 * common**2)
        return lean, float(np.sqrt(variance))
