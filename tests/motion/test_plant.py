"""The hub's motion under waves: derivatives, size, spectrum, energy; against a time integration."""

from functools import partial
from pathlib import Path

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from owtsweep.motion.plant import Plant, respond
from owtsweep.motion.source import Motion
from owtsweep.streams import stream
from owtsweep.structures import read_structure
from owtsweep.waves import Sea

STRUCTURE = read_structure(Path(__file__).parents[2] / "conf" / "structure" / "ren2019.yaml")
ALONG = np.cos(np.pi / 6.0)  # the waves come from 30 degrees, x is north


def draw(hs: float, tp: float, step: float = 0.01, replicate: int = 0) -> Motion:
    """Draw 2000 s of motion."""
    plant, steps = Plant(STRUCTURE, Sea(hs, tp)), round(2000.0 / step)
    return plant.realise(
        partial(stream, 7, "plant", (), replicate), steps=steps, step=step, history=20
    )


@pytest.fixture(scope="module")
def motion() -> Motion:
    return draw(2.87, 6.03)


def test_velocity_and_acceleration_are_the_derivatives(motion):
    t = np.arange(len(motion.position)) * motion.step
    # seventh-order differences: five points to each side are too few only above 10 Hz
    weights = np.array([-1 / 1260, 5 / 504, -5 / 84, 5 / 21, -5 / 6])
    for series, derivative in (
        (motion.position, motion.velocity), (motion.velocity, motion.acceleration),
    ):  # fmt: skip
        found = sum(
            w * (series[i : len(t) - 10 + i] - series[10 - i : len(t) - i])
            for i, w in enumerate(weights)
        )
        error = found / motion.step - derivative[5:-5]
        assert error.std() < 1e-6 * derivative.std()


def test_the_size_is_that_of_the_paper():
    accepted = (((2.87, 6.03), 0.24, 0.34), ((2.0, 8.0), 0.10, 0.17), ((2.0, 6.0), 0.17, 0.27))
    for (hs, tp), low, high in accepted:  # m, along the waves; 2000 s scatter by some 6 %
        rms = [draw(hs, tp, 0.1, replicate).position.std() for replicate in range(4)]
        assert low < np.mean(rms) < high


def test_the_resonance_dominates(motion):
    power = np.abs(np.fft.rfft(motion.position)) ** 2
    frequency = np.fft.rfftfreq(len(motion.position), motion.step)
    resonance = (frequency >= 0.2) & (frequency <= 0.32)
    assert power[resonance].sum() / power[1:].sum() > 0.9
    assert 0.7 < ALONG * np.abs(motion.position).max() < 1.3


def test_positions_before_the_start_join_the_record(motion):
    joined = np.concatenate([motion.before, motion.position[:20]])
    assert np.abs(np.diff(joined, 4)).max() < 1e-6


def test_the_slope_is_that_of_the_first_mode_nearly(motion):
    leans = (motion.acceleration - motion.felt) / STRUCTURE.gravity
    slope = leans @ motion.position / (motion.position @ motion.position)
    assert slope == pytest.approx(0.0137, rel=0.03)


def test_modes_answer_as_a_time_integration_says():
    plant = Plant(STRUCTURE, Sea(2.0, 6.0), modes=1)
    modes = plant.vibration
    period = 400.0
    load = np.zeros((1, int(2.0 * period) + 1), dtype=complex)
    load[0, [60, 103]] = 2e4, 1e4j  # .15 Hz, and .2575 Hz near the resonance
    answer = respond(modes, np.array([STRUCTURE.hub]), load, period)[0]  # shapes are 1 there
    own = 2.0 * np.pi * modes.frequency[0]

    def force(t: float) -> float:
        angles = 2.0 * np.pi * np.array([60, 103]) / period * t
        return float((load[0, [60, 103]] * np.exp(1j * angles)).real.sum())

    def rates(t: float, state: np.ndarray) -> list[float]:
        q, v = state
        return [v, force(t) / modes.mass[0] - 2.0 * modes.damping * own * v - own**2 * q]

    numbers = np.arange(len(answer))

    def steady(t: float) -> float:
        return float((answer * np.exp(2j * np.pi * numbers / period * t)).real.sum())

    speed = answer * 2j * np.pi * numbers / period
    begin = [steady(0.0), float(speed.real.sum())]
    times = np.linspace(0.0, 50.0, 101)
    solution = solve_ivp(rates, (0.0, 50.0), begin, t_eval=times, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose(solution.y[0], [steady(t) for t in times], atol=1e-6)


def test_the_energy_of_a_free_decay_goes_into_the_damping():
    modes = Plant(STRUCTURE, Sea(2.0, 6.0), modes=1).vibration
    period, count = 400.0, 40_000
    impulse = np.full((1, count // 2), 2.0 / period, dtype=complex)  # 1 N s at the hub at t = 0
    answer = respond(modes, np.array([STRUCTURE.hub]), impulse, period)[0]
    own, mass, time = 2.0 * np.pi * modes.frequency[0], modes.mass[0], np.arange(count) * 0.01
    speed = 2j * np.pi * np.arange(len(answer)) / period

    def sample(lines: np.ndarray) -> np.ndarray:
        return np.fft.irfft(lines * (0.5 * count), count)

    x = sample(answer) + 1.0 / (period * mass * own**2)  # with the mean, which is no motion
    v = sample(answer * speed)
    energy = 0.5 * mass * (v**2 + own**2 * x**2)
    lost = 2.0 * modes.damping * own * mass * np.cumsum(v**2) * 0.01
    part = (time > 2.0) & (time < 200.0)
    balance = energy[part] + lost[part]
    np.testing.assert_allclose(balance, balance[0], rtol=2e-3)
    cycles = 10 * 2.0 * np.pi / (own * np.sqrt(1.0 - modes.damping**2))
    later = np.interp(2.0 + cycles, time, energy) / energy[200]
    assert later == pytest.approx(np.exp(-2.0 * modes.damping * own * cycles), rel=2e-3)
    assert energy[200] == pytest.approx(
        0.5 / mass * np.exp(-2.0 * modes.damping * own * 2.0), rel=2.0 * modes.damping
    )
