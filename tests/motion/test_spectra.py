"""Spectra: the digits of Table 4, the peak, and what cannot be."""

from __future__ import annotations

from decimal import ROUND_HALF_EVEN, Decimal

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from owtsweep.errors import InputError
from owtsweep.motion.source import Spectrum, printed, translated
from owtsweep.studies.hub.config import SpectrumConfig

#: b and c as Table 4 prints them.
PRINTED = {
    3.0: ("-0.67", "0.11"),
    4.0: ("-0.50", "0.062"),
    5.0: ("-0.40", "0.040"),
    6.0: ("-0.33", "0.028"),
    7.0: ("-0.28", "0.020"),
    8.0: ("-0.25", "0.016"),
}
#: REPRODUCTION.md: the bandwidths k that give all 12 numbers.
LOWEST, HIGHEST = 1.0204e-4, 5.556e-4


def rounded(value: float, like: str) -> Decimal:
    """Round as a table does: to the digits of `like`, halves to even (.0625 -> .062)."""
    decimal = Decimal(repr(value)).quantize(Decimal("1e-12"), ROUND_HALF_EVEN)
    return decimal.quantize(Decimal(like), ROUND_HALF_EVEN)


def digits_agree(bandwidth: float) -> list[bool]:
    return [
        rounded(value, like) == Decimal(like)
        for period, pair in PRINTED.items()
        for value, like in zip(
            (translated(period, bandwidth).b, translated(period, bandwidth).c), pair, strict=True
        )
    ]


def test_default_bandwidth_gives_all_twelve_digits() -> None:
    assert digits_agree(2.4e-4) == [True] * 12
    assert digits_agree(translated.__defaults__[0]) == [True] * 12


@settings(derandomize=True, max_examples=30, deadline=None)
@given(st.floats(LOWEST + 1e-7, HIGHEST - 1e-7))
def test_the_whole_interval_gives_them(bandwidth: float) -> None:
    assert all(digits_agree(bandwidth))


@pytest.mark.parametrize("bandwidth", [LOWEST - 1e-6, HIGHEST + 1e-6, 6.7e-6])
def test_beyond_it_some_digit_differs(bandwidth: float) -> None:
    assert not all(digits_agree(bandwidth))


@pytest.mark.parametrize("shape", [translated(3.0), translated(8.0, 6.7e-6), printed(6.0)])
def test_peak_is_where_the_derivative_vanishes(shape: Spectrum) -> None:
    peak = np.sqrt(shape.c)
    assert shape.peak_frequency == pytest.approx(peak)
    step = 1e-6 * peak
    low, top, high = shape.density(peak + np.array([-step, 0.0, step]))
    assert top == pytest.approx(shape.a / (2 * peak + shape.b))
    assert top >= max(low, high)
    # Eq. (2), -a (f^2 - c) / (f^2 + b f + c)^2, at the peak and beside it
    for f in (peak, 0.9 * peak, 1.2 * peak):
        below, above = shape.density(np.array([f - step, f + step]))
        slope = -shape.a * (f**2 - shape.c) / (f**2 + shape.b * f + shape.c) ** 2
        assert (above - below) / (2 * step) == pytest.approx(slope, rel=1e-4, abs=1e-4 * top / peak)


@settings(derandomize=True, max_examples=30, deadline=None)
@given(st.floats(2.0, 12.0), st.floats(1e-6, 5e-3))
def test_translated_is_finite_with_its_peak_at_the_natural_frequency(
    period: float, bandwidth: float
) -> None:
    shape = translated(period, bandwidth)
    f = np.linspace(0.005, 2.0, 4001)
    assert np.all(shape.density(f) > 0.0)
    assert shape.peak_frequency == pytest.approx(1.0 / period)
    assert shape.peak_margin == pytest.approx(bandwidth * period, rel=1e-6)


@pytest.mark.parametrize("period", [3.0, 4.0, 5.0])
def test_printed_refuses_what_has_no_finite_peak(period: float) -> None:
    with pytest.raises(
        InputError, match=rf"^spectrum=printed .* at {period:g} s .*=translated, or "
    ):
        printed(period)


@pytest.mark.parametrize("period", [6.0, 7.0, 8.0])
def test_printed_is_table_4(period: float) -> None:
    shape = printed(period)
    assert (shape.b, shape.c) == tuple(map(float, PRINTED[period]))
    assert np.all(shape.density(np.linspace(0.01, 1.0, 1000)) > 0.0)


def test_unknown_kinds_and_periods_are_refused() -> None:
    with pytest.raises(InputError, match=r"Table 4 has no natural period 6\.5 s"):
        printed(6.5)
    assert SpectrumConfig(kind="printed", bandwidth=1.0).at(6.0) == printed(6.0)
    assert SpectrumConfig(kind="translated", bandwidth=1e-4).at(6.0) == translated(6.0, 1e-4)
