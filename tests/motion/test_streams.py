"""Named streams: the same bits again, and nothing shared between any two of them."""

from __future__ import annotations

from zlib import crc32

import numpy as np

from owtsweep.streams import stream

NAMES = ("phase", "imu_x", "imu_y", "bias_x", "bias_y", "gnss")


def test_the_same_key_gives_the_same_bits() -> None:
    draws = [stream(2019, "hub", (4.0,), 3, "imu_x").standard_normal(1000) for _ in range(2)]
    np.testing.assert_array_equal(*draws)


def test_streams_are_independent() -> None:
    keys = [
        *((1, "hub", (4.0,), 0, name) for name in NAMES),
        (2, "hub", (4.0,), 0, "phase"),
        (1, "hub", (4.0,), 1, "phase"),
        (1, "hub", (4.000001,), 0, "phase"),
        (1, "other", (4.0,), 0, "phase"),
        (1, "hub", (4.0, 1.0), 0, "phase"),
        (1, "hub", ("clay",), 0, "phase"),
        (1, "hub", (-4.0,), 0, "phase"),
        (1, "hub", (), 0, "phase"),
    ]
    draws = np.array([stream(*key).standard_normal(20_000) for key in keys])
    correlation = np.corrcoef(draws)
    off = correlation[~np.eye(len(keys), dtype=bool)]
    assert np.max(np.abs(off)) < 5 / np.sqrt(20_000)  # five standard deviations
    assert np.all(np.abs(draws.mean(axis=1)) < 5 / np.sqrt(20_000))
    assert np.all(np.abs(draws.std(axis=1) - 1) < 5 / np.sqrt(2 * 20_000))


def test_periods_are_resolved_to_a_microsecond() -> None:
    a = stream(1, "hub", (4.0,), 0, "gnss").random()
    assert stream(1, "hub", (4.0 + 1e-9,), 0, "gnss").random() == a


def test_drawing_more_changes_no_earlier_number() -> None:
    few = stream(1, "hub", (4.0,), 0, "gnss").standard_normal((10, 2))
    many = stream(1, "hub", (4.0,), 0, "gnss").standard_normal((50, 2))
    np.testing.assert_array_equal(many[:10], few)


def test_one_condition_has_the_key_that_it_always_had() -> None:
    key = (crc32(b"hub"), 4_000_000, 3, crc32(b"imu_x"))
    sequence = np.random.SeedSequence(2019, spawn_key=key)
    expected = np.random.Generator(np.random.SFC64(sequence)).random(5)
    np.testing.assert_array_equal(stream(2019, "hub", (4.0,), 3, "imu_x").random(5), expected)
