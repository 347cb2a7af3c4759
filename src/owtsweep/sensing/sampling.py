"""The reports of a slow sensor: their interval and delay, in steps of the fastest sensor."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from owtsweep.errors import InputError

#: Greatest distance from a whole number at which a ratio counts as whole, to allow for rounding.
WHOLE = 1e-6


@dataclass(frozen=True)
class Sampling:
    """A sensor that reports at the steps 0, interval, 2 interval, ...

    Attributes
    ----------
    interval
        Steps between its reports.
    delay
        Steps from the time of measurement of a report to its arrival.

    Raises
    ------
    InputError
        If the interval is not positive or the delay is negative.
    """

    interval: int
    delay: int = 0

    def __post_init__(self) -> None:
        if self.interval < 1:
            raise InputError(f"interval: {self.interval} steps; give 1 or more")
        if self.delay < 0:
            raise InputError(f"delay: {self.delay} steps; give 0 or more")

    def count(self, steps: int) -> int:
        """The number of reports that arrive in a record of `steps` steps."""
        return -(-steps // self.interval)

    def arrivals(self, steps: int) -> NDArray[np.int64]:
        """(count,): the steps at which reports arrive."""
        return self.interval * np.arange(self.count(steps))

    def instants(self, steps: int) -> NDArray[np.int64]:
        """(count,): the steps at which reports were measured; negative before the record begins."""
        return self.arrivals(steps) - self.delay


def make_sampling(rate: float, delay: float, base_rate: float) -> Sampling:
    """The sampling of a sensor whose rate divides a base rate.

    Parameters
    ----------
    rate, base_rate
        In Hz.
    delay
        In s, a multiple of the base step.

    Raises
    ------
    InputError
        If the rate does not divide the base rate, or the delay is no multiple of the base step.
    """
    if not 0.0 < rate <= base_rate:
        raise InputError(f"rate: {rate:g} Hz is not between 0 and the base rate {base_rate:g} Hz")
    ratio = base_rate / rate
    if abs(ratio - round(ratio)) > WHOLE * ratio:
        low, high = base_rate / np.ceil(ratio), base_rate / np.floor(ratio)
        raise InputError(
            f"rate: {rate:g} Hz does not divide the base rate {base_rate:g} Hz; use {low:.6g} or "
            f"{high:.6g}"
        )
    late = delay * base_rate
    if abs(late - round(late)) > WHOLE * max(late, 1.0):
        raise InputError(
            f"delay: {delay:g} s is no multiple of the base step {1.0 / base_rate:g} s; use "
            f"{round(late) / base_rate:.6g}"
        )
    return Sampling(round(ratio), round(late))
