"""Rate and delay of a sensor, in steps."""

from __future__ import annotations

import pytest

from owtsweep.errors import InputError
from owtsweep.sensing.sampling import Sampling, make_sampling


def test_reports_are_about_earlier_instants() -> None:
    gnss = make_sampling(rate=1.0, delay=0.2, base_rate=100.0)
    assert gnss == Sampling(interval=100, delay=20)
    assert gnss.count(201) == 3
    assert gnss.arrivals(201).tolist() == [0, 100, 200]
    assert gnss.instants(201).tolist() == [-20, 80, 180]


@pytest.mark.parametrize("steps", [0, 1, 6, 7, 8, 14, 15])
def test_the_count_is_that_of_the_arrivals_in_the_record(steps: int) -> None:
    assert Sampling(7).count(steps) == len(range(0, steps, 7))


@pytest.mark.parametrize(
    ("rate", "delay", "message"),
    [
        (3.0, 0.0, "rate: 3 Hz does not divide the base rate 100 Hz; use 2.94118 or 3.0303"),
        (200.0, 0.0, "rate: 200 Hz is not between 0 and the base rate 100 Hz"),
        (0.0, 0.0, "rate: 0 Hz is not between"),
        (1.0, 0.015, "delay: 0.015 s is no multiple of the base step 0.01 s; use 0.0[12]"),
        (1.0, -0.01, "delay: -1 steps; give 0 or more"),
    ],
)
def test_rates_and_delays_that_do_not_fit(rate: float, delay: float, message: str) -> None:
    with pytest.raises(InputError, match=message):
        make_sampling(rate, delay, 100.0)


def test_an_interval_of_nothing() -> None:
    with pytest.raises(InputError, match="interval: 0 steps; give 1 or more"):
        Sampling(0)


def test_ratios_are_whole_but_for_round_off() -> None:
    assert make_sampling(rate=0.1, delay=0.3, base_rate=30.0) == Sampling(300, 9)
    assert make_sampling(rate=1 / 3, delay=0.07, base_rate=100.0) == Sampling(300, 7)
