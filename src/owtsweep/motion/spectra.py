"""Motion spectra S(f) = a f / (f^2 + b f + c), Eq. (1) of Ren et al. (2019).

The peak lies at f* = sqrt(c), Eq. (2). The denominator must be positive for every f > 0. This holds
if, and only if, 2 sqrt(c) + b > 0. (At the peak, the denominator is f* (2 sqrt(c) + b).)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from owtsweep.arrays import Array
from owtsweep.errors import InputError

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
