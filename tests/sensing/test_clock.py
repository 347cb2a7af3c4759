"""A wrong clock reports the motion of another instant."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.errors import InputError
from owtsweep.sensing.clock import Clock

STEP, START = 0.01, -1.0
TIME = START + STEP * np.arange(1200)
STAMPED = np.arange(0.0, 10.0, 0.25)


def motion(time: np.ndarray) -> np.ndarray:
    return np.stack([np.sin(2 * np.pi * 0.6 * time), np.cos(time)], axis=-1)


@pytest.mark.parametrize(
    "clock", [Clock(), Clock(0.3), Clock(-0.2037), Clock(drift=1e-3), Clock(-0.1, 0.02)], ids=str
)
def test_it_reports_the_motion_at_the_shifted_instant(clock: Clock) -> None:
    reported = clock.read(motion(TIME), start=START, step=STEP, stamped=STAMPED)
    expected = motion(STAMPED + clock.offset + clock.drift * STAMPED)
    np.testing.assert_allclose(reported, expected, atol=1e-9)


def test_one_axis_stays_one_axis() -> None:
    reported = Clock(0.1).read(TIME, start=START, step=STEP, stamped=STAMPED)
    np.testing.assert_allclose(reported, STAMPED + 0.1, atol=1e-10)


@pytest.mark.parametrize(("offset", "missing"), [(-1.5, "0.5"), (1.74, "0.5")])
def test_instants_outside_the_motion(offset: float, missing: str) -> None:
    with pytest.raises(InputError, match=f"up to {missing} s outside the motion; lengthen it"):
        Clock(offset).read(TIME, start=START, step=STEP, stamped=STAMPED)


def test_a_clock_that_stands_still() -> None:
    with pytest.raises(InputError, match="drift: -1 s/s stops the clock"):
        Clock(drift=-1.0)
