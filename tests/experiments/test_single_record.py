"""Could one record have printed a number? By brute force, known limits and degenerate records."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats

from experiments.single_record import judge, place_print, read_rounded, show_chance


@pytest.mark.parametrize("n", [2, 5, 20, 100])
def test_a_print_of_the_same_kind_disagrees_in_one_of_twenty(n: int) -> None:
    """Whatever the number of records is; also of errors as skewed as a mean of few squares."""
    draw = np.random.default_rng(n)
    records = np.exp(0.7 * draw.standard_normal((8000, n + 1)) - 5.0)
    chances = np.array([place_print(one[0], one[0], one[1:]).chance for one in records])
    for level in (0.05, 0.3, 0.8):
        assert np.mean(chances < level) == pytest.approx(
            level, abs=4 * np.sqrt(level * (1 - level) / 8000)
        )
    squares = draw.chisquare(12, (8000, n + 1)) / 12
    no = np.mean([place_print(one[0], one[0], one[1:]).agrees == "no" for one in squares])
    assert 0.03 < no < 0.08


def test_the_chance_is_the_part_of_records_as_far_away() -> None:
    """Brute force: draw mean and spread as the records leave them open, then one more record."""
    draw = np.random.default_rng(7)
    samples = np.exp(draw.normal(-2.0, 0.5, 8))
    logs, printed = np.log(samples), 0.3
    spread = logs.std(ddof=1) * np.sqrt(7.0 / draw.chisquare(7, 400_000))
    mean = logs.mean() + spread / np.sqrt(8.0) * draw.standard_normal(400_000)
    more = mean + spread * draw.standard_normal(400_000)
    far = np.abs(more - logs.mean()) >= abs(np.log(printed) - logs.mean())
    place = place_print(printed, printed, samples)
    assert place.chance == pytest.approx(np.mean(far), abs=0.003)
    ends = np.exp(np.quantile(more, [0.025, 0.975]))
    assert (place.low, place.high) == pytest.approx(tuple(ends), rel=0.03)


def test_with_many_records_it_is_their_spread_and_not_the_error_of_their_mean() -> None:
    samples = np.exp(np.random.default_rng(3).standard_normal(200_000))
    place = place_print(np.exp(1.5), np.exp(1.5), samples)
    assert place.chance == pytest.approx(2.0 * stats.norm.sf(1.5), abs=0.01)
    assert (place.low, place.high) == pytest.approx(
        tuple(np.percentile(samples, [2.5, 97.5])), rel=0.03
    )


def test_the_ends_are_where_the_chance_is_one_twentieth() -> None:
    samples = np.array([1.0, 2.0, 3.0, 5.0])
    place = place_print(2.0, 2.0, samples)
    for end in (place.low, place.high):
        assert place_print(end, end, samples).chance == pytest.approx(0.05)
    assert place.agrees == "yes"
    assert place_print(1.1 * place.high, 1.1 * place.high, samples).agrees == "no"
    scaled = place_print(2e-6, 2e-6, 1e-6 * samples)
    assert scaled.chance == pytest.approx(place.chance)  # no unit matters


def test_what_rounds_to_the_print_is_no_distance() -> None:
    assert read_rounded("1.000") == (0.9995, 1.0005)
    assert read_rounded("8e-6") == pytest.approx((7.5e-6, 8.5e-6))
    assert read_rounded("13.61e-3") == pytest.approx((0.013605, 0.013615))
    errors = np.array([1e-6, 2e-6, 3e-5])  # 1 - TRAC of records that all print 1.000
    least, greatest = read_rounded("1.000")
    assert place_print(1.0 - greatest, 1.0 - least, errors).chance == 1.0
    assert place_print(0.1, 0.1, errors).chance < 0.05
    wide = place_print(1.5e-6, 2.5e-6, errors)
    assert wide.chance > place_print(1.5e-6, 1.5e-6, errors).chance


def test_signed_values_are_taken_as_they_are() -> None:
    samples = np.array([-1.0, 0.0, 1.0])
    place = place_print(2.0, 2.0, samples)
    assert place.chance == pytest.approx(2.0 * stats.t.sf(2.0 / np.sqrt(4.0 / 3.0), 2))
    assert place.low == -place.high


@pytest.mark.parametrize(
    "samples", [[1.0], [1.0, 1.0], [0.0, 0.0], [1.0, 1.0 + 1e-15], [np.nan, 1.0], [np.inf, 1.0]]
)
def test_without_scatter_there_is_no_chance(samples: list[float]) -> None:
    place = place_print(1.0, 1.0, np.array(samples))
    assert np.isnan([place.chance, place.low, place.high]).all()
    assert place.agrees == "undecided"


def test_chances_in_words() -> None:
    assert [judge(p) for p in (0.0501, 0.0499, np.nan)] == ["yes", "no", "undecided"]
    assert [show_chance(p) for p in (1.0, 0.25, 2e-4, np.nan)] == ["1", ".2", "<.001", "–"]
