"""Checks that cannot be declared with a single field."""

from __future__ import annotations

import math

from owtsweep.errors import InputError

#: A time counts as a multiple of a step if it is one within this fraction of the step.
GRAIN = 1e-6


def require(condition: bool, message: str) -> None:
    """Raise `InputError(message)` unless the condition holds."""
    if not condition:
        raise InputError(message)


def require_multiple(key: str, value: float, step: float, name: str) -> None:
    """Refuse a time (s) that is not a whole number of steps (s); suggest the two nearest times.

    Raises
    ------
    InputError
        One line that names the key; `name` says what the step is.
    """
    count = value / step
    if abs(count - round(count)) > GRAIN * max(1.0, count):
        low, high = math.floor(count) * step, math.ceil(count) * step
        raise InputError(
            f"{key}: {value:g} s is no multiple of the {name} {step:g} s; use {low:.10g} or "
            f"{high:.10g}"
        )
