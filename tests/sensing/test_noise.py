"""Noise and bias: statistics against theory, and the same normals whatever scales them."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.sensing.noise import WienerBias
from owtsweep.streams import stream
from owtsweep.studies import compose
from owtsweep.studies.hub.sensors import ForceNoise, sensors


def normals(name: str = "imu_x") -> np.random.Generator:
    return stream(2019, "hub", (4.0,), 0, name)


def white_noise(sigma: float) -> ForceNoise:
    """Specific forces of the hub study, with neither bias nor gravity in them."""
    still = ["sensors.imu.bias_walk=0", "sensors.imu.bias_initial=0"]
    config = compose([f"sensors.imu.sigma={sigma}", *still]).sensors
    return ForceNoise(config, sensors(config), normals)


def test_white_noise_has_its_deviation_and_no_memory() -> None:
    noise = white_noise(0.15).next(100_000)[:, 0]
    assert np.std(noise) == pytest.approx(0.15, rel=5 / np.sqrt(2 * 100_000))
    lagged = np.mean(noise[1:] * noise[:-1]) / 0.15**2
    assert abs(lagged) < 5 / np.sqrt(100_000)


def test_the_variance_of_a_bias_grows_with_time() -> None:
    steps, step, walk = 200, 0.5, 1e-3
    ends = np.array([
        WienerBias(normals(f"bias_{i}"), walk, step, initial=0.05).draw(steps)[[0, 50, -1]]
        for i in range(4000)
    ])  # fmt: skip
    np.testing.assert_array_equal(ends[:, 0], 0.05)
    for column, k in ((1, 50), (2, steps - 1)):
        variance = np.var(ends[:, column])
        assert variance == pytest.approx(walk**2 * k * step, rel=5 * np.sqrt(2 / 4000))


@pytest.mark.parametrize("pieces", [[1000], [1, 999], [300, 0, 699, 1]])
def test_pieces_are_those_of_one_draw(pieces: list[int]) -> None:
    whole = white_noise(0.1).next(1000), WienerBias(normals(), 0.2, 0.01).draw(1000)
    white, bias = white_noise(0.1), WienerBias(normals(), 0.2, 0.01)
    np.testing.assert_array_equal(np.concatenate([white.next(n) for n in pieces]), whole[0])
    np.testing.assert_array_equal(np.concatenate([bias.draw(n) for n in pieces]), whole[1])


def test_another_intensity_is_the_same_noise() -> None:
    np.testing.assert_array_equal(white_noise(0.5).next(100), 2 * white_noise(0.25).next(100))
    one, two = (WienerBias(normals(), walk, 1.0).draw(100) for walk in (1.0, 2.0))
    np.testing.assert_array_equal(two, 2 * one)
    away = WienerBias(normals(), 1.0, 1.0, initial=3.0).draw(100)
    np.testing.assert_allclose(away - 3.0, one, atol=1e-12)
