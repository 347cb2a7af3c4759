"""The floater's truth: derivatives, sizes, what lies between samples, attitude, decay."""

from __future__ import annotations

from dataclasses import replace
from functools import cache, partial

import numpy as np
import pytest
from linear_records import move
from scipy.signal import freqs
from scipy.spatial.transform import Rotation

from owtsweep.estimation.inertial.angles import find_body_rates
from owtsweep.gravity import GRAVITY
from owtsweep.motion.lines import Span
from owtsweep.streams import stream
from owtsweep.studies import compose
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.motion_synthetic import draw_motion
from owtsweep.studies.floater.truth import MARGIN, Motion, find_specific_force, make_truth

SHORT = ["study=floater", "record.duration=100", "record.rate=10", "record.settling=10"]


@cache
def configure(*words):
    return compose([*SHORT, *words])


def period(*words, replicate=0, roll=None):
    """Return one period of 2000 samples (twice the record), after which a motion repeats."""
    config = configure(*words)
    draws = partial(stream, config.seed, config.study, (), replicate)
    return draw_motion(config.motion, draws, Span(1000, 0.1, 1000), roll)


def differentiate(values, step):
    """Return the derivative of one period by its Fourier transform."""
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(values), step)[:, None]
    return np.fft.irfft(1j * omega * np.fft.rfft(values, axis=0), len(values), axis=0)


def test_position_velocity_and_acceleration_are_exact_derivatives() -> None:
    position, velocity, acceleration = period()
    for value, slope in ((position, velocity), (velocity, acceleration)):
        assert np.abs(differentiate(value, 0.1) - slope).max() < 1e-11 * np.abs(slope).max() + 1e-13
    truth = make_truth(configure(), 3).truth
    for value, slope in ((truth.position, truth.velocity), (truth.velocity, truth.acceleration)):
        assert (
            np.abs(np.gradient(value, truth.step, axis=0) - slope)[1:-1].max() < 0.01 * slope.max()
        )


def test_parts_have_the_sizes_of_the_configuration() -> None:
    """Each alone, over a whole period: exactly; degrees become radians."""
    config = configure()
    unit = np.array([1.0] * 3 + [np.pi / 180.0] * 3)
    sigma = unit * [config.motion.freedoms[name].resonance.sigma for name in DOF]
    waves = unit * [config.motion.freedoms[name].waves for name in DOF]
    mean = unit * [config.motion.freedoms[name].mean for name in DOF]
    slow = period(*(f"motion.freedoms.{name}.waves=0" for name in DOF)).position
    fast = period(*(f"motion.freedoms.{name}.resonance.sigma=0" for name in DOF)).position
    assert slow.mean(axis=0) == pytest.approx(mean, abs=1e-12)
    assert slow.std(axis=0) == pytest.approx(sigma)
    assert fast.std(axis=0) == pytest.approx(waves)
    # Together they have their sum, but for how the draws happen to agree.
    both = np.mean([period(replicate=i).position.var(axis=0) for i in range(100)], axis=0)
    assert both == pytest.approx(sigma**2 + waves**2, rel=0.03)


def test_the_slow_part_is_white_noise_through_an_oscillator() -> None:
    wide = ("waves=0", "resonance.damping=0.3")  # many lines, so that a draw's size counts little
    words = [f"motion.freedoms.{name}.{word}" for name in DOF for word in wide]
    words += [f"motion.freedoms.{name}.resonance.period={8 + i}" for i, name in enumerate(DOF)]
    config = configure(*words)
    drawn = [period(*words, replicate=i).velocity for i in range(200)]
    power = np.mean([np.abs(np.fft.rfft(each, axis=0)) ** 2 for each in drawn], axis=0)
    frequency = np.fft.rfftfreq(2000, 0.1)
    for column, name in enumerate(DOF):
        resonance = config.motion.freedoms[name].resonance
        natural = 2.0 * np.pi / resonance.period
        _, response = freqs([1.0, 0.0], [1.0, 2.0 * resonance.damping * natural, natural**2],
                            2.0 * np.pi * frequency)  # fmt: skip
        wanted = np.abs(response) ** 2 * (frequency * resonance.period <= 3.0)
        shares = [each / each.sum() for each in (power[:, column], wanted)]
        assert shares[0] == pytest.approx(shares[1], abs=0.015)
        assert shares[0][wanted == 0.0].sum() < 1e-20


def test_roll_is_scaled_to_what_the_grid_says() -> None:
    plain, scaled = period().position, period(roll=7.0).position
    size = np.rad2deg(scaled[:, 3].std())
    assert size == pytest.approx(7.0)
    assert np.delete(plain, 3, axis=1) == pytest.approx(np.delete(scaled, 3, axis=1))
    ratio = (scaled[:, 3] - scaled[:, 3].mean()) / (plain[:, 3] - plain[:, 3].mean())
    assert np.ptp(ratio) < 1e-9 * ratio.mean()


@pytest.mark.parametrize("coupling", [0.5, 1.0])
def test_pitch_follows_surge_and_roll_minus_sway(coupling: float) -> None:
    alike = [
        f"motion.freedoms.{name}.{key}" for name in ("x", "y", "phi", "theta")
        for key in ("resonance.period=35", "resonance.damping=0.05", "resonance.sigma=1", "waves=1")
    ]  # fmt: skip
    positions = [
        period(*alike, f"motion.surge_pitch={coupling}", replicate=i).position for i in range(200)
    ]
    correlation = np.mean([np.corrcoef(each.T) for each in positions], axis=0)
    wanted = np.eye(6)
    wanted[0, 4] = wanted[4, 0] = coupling
    wanted[1, 3] = wanted[3, 1] = -coupling
    assert correlation == pytest.approx(wanted, abs=0.1)
    if coupling == 1.0:
        assert correlation[0, 4] == pytest.approx(1.0)


def test_between_samples_the_error_is_that_of_degree_five() -> None:
    """Against all lines evaluated in between; halving the step divides it by 64."""
    series = period()
    lines = np.fft.rfft(series.position, axis=0)
    omega = 2.0 * np.pi * np.fft.rfftfreq(2000, 0.1)[:, None]
    dense = 8.0 * np.fft.irfft(lines, 16000, axis=0)
    sixth = np.fft.irfft(-(omega**6) * lines, 2000, axis=0)
    errors = []
    for every, step in ((2, 0.2), (1, 0.1)):
        kept = type(series)(*(part[::every] for part in series))
        motion = Motion(replace(make_truth(configure(), 0).truth, step=step), kept, 0, 0)
        error = np.abs(motion.at(0.0125 * np.arange(15900)) - dense[:15900]).max(axis=0)
        # The remainder of Hermite's interpolation: x^(6) (h/2)^6 / 6!.
        remainder = np.abs(sixth).max(axis=0) * (step / 2.0) ** 6 / 720.0
        assert error == pytest.approx(remainder, rel=0.05)
        errors.append(error)
    assert errors[0] / errors[1] == pytest.approx(64.0, rel=0.05)


def test_samples_and_what_came_before_them() -> None:
    config = configure("grid.delay=[0,30.5]")
    motion = make_truth(config, 1)
    assert motion.lead == 31 + MARGIN
    times = 0.1 * np.arange(1000)
    assert motion.at(times) == pytest.approx(motion.truth.position, abs=1e-12)
    early = motion.at(np.array([-5.0, -3.1]))
    assert early[1] == pytest.approx(motion.series.position[motion.lead - 31], abs=1e-12)
    assert motion.at(np.array([-1000.0, 1e6])) == pytest.approx(motion.series.position[[0, -1]])
    # More delay asks for a longer lead, and changes nothing else.
    assert make_truth(configure(), 1).truth.position == pytest.approx(motion.truth.position)


def large_angles(size):
    """Return angles, their rates and accelerations of positions, at times about those of rows."""

    def angles(times):
        return size * 40.0 * move(times, 7)[0][:, 3:]

    times = np.linspace(0.0, 100.0, 300)
    moved = move(times, 7)
    return times, angles, size * 40.0 * moved[1][:, 3:], moved[2][:, :3]


def test_body_rates_are_those_of_the_turning_body() -> None:
    times, angles, rates, _ = large_angles(1.0)
    assert 0.5 < np.abs(angles(times)).max() < 1.5

    def attitude(t):
        return Rotation.from_euler("ZYX", angles(t)[:, ::-1])

    h = 1e-4
    turned = (attitude(times - h).inv() * attitude(times + h)).as_rotvec() / (2.0 * h)
    assert find_body_rates(angles(times), rates) == pytest.approx(turned, abs=1e-7)


def test_specific_force_is_the_acceleration_without_gravity_in_the_body() -> None:
    times, angles, _, acceleration = large_angles(1.0)
    felt = find_specific_force(angles(times), acceleration, small=False)
    for (roll, pitch, yaw), a, f in zip(angles(times), acceleration, felt, strict=True):
        about_x = [[1, 0, 0], [0, np.cos(roll), np.sin(roll)], [0, -np.sin(roll), np.cos(roll)]]
        about_y = [[np.cos(pitch), 0, -np.sin(pitch)], [0, 1, 0], [np.sin(pitch), 0, np.cos(pitch)]]
        about_z = [[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]]
        to_body = np.array(about_x) @ about_y @ about_z
        assert f == pytest.approx(to_body @ (a - [0.0, 0.0, GRAVITY]), abs=1e-12)
    rest = find_specific_force(np.zeros((1, 3)), np.zeros((1, 3)), small=False)
    assert rest[0] == pytest.approx([0.0, 0.0, -GRAVITY])


def test_small_angles_are_the_limit_of_exact_ones() -> None:
    """Differences fall with the square of the angles; gravity's part is first order in both."""
    rates, forces = [], []
    for size in (1e-2, 1e-3):
        times, angles, turning, acceleration = large_angles(size)
        a = size * acceleration  # turned accelerations are of the same order as turned gravity's
        rates.append(np.abs(find_body_rates(angles(times), turning) - turning).max())
        exact, small = (find_specific_force(angles(times), a, small=k) for k in (False, True))
        forces.append(np.abs(exact - small).max())
        assert forces[-1] < 0.02 * np.abs(small[:, :2]).max()
    assert rates[0] / rates[1] == pytest.approx(100.0, rel=0.1)
    assert forces[0] / forces[1] == pytest.approx(100.0, rel=0.1)


def test_a_record_has_the_rates_and_forces_of_its_own_motion() -> None:
    for kind in ("small", "exact"):
        truth = make_truth(configure(f"motion.attitude={kind}"), 2, 10.0).truth
        angles, speed = truth.position[:, 3:], truth.velocity[:, 3:]
        rate = speed if kind == "small" else find_body_rates(angles, speed)
        assert truth.rate == pytest.approx(rate)
        felt = find_specific_force(angles, truth.acceleration[:, :3], small=kind == "small")
        assert truth.specific_force == pytest.approx(felt)


def test_a_decay_solves_its_equation_and_rests_before_its_release() -> None:
    config = compose(["study=floater", "motion=decay", "record.duration=20", "grid.delay=[0,5]"])
    motion = make_truth(config, 0)
    truth, lead = motion.truth, motion.lead
    for column, name in enumerate(DOF):
        freedom = config.motion.freedoms[name]
        unit = 1.0 if column < 3 else np.pi / 180.0
        natural = 2.0 * np.pi / freedom.resonance.period
        x, v, a = (part[:, column] for part in (truth.position, truth.velocity, truth.acceleration))
        rest = a + 2.0 * freedom.resonance.damping * natural * v
        rest += natural**2 * (x - unit * freedom.mean)
        assert np.abs(rest).max() < 1e-12 * np.abs(a).max()
        assert x[0] == pytest.approx(unit * (freedom.mean + freedom.resonance.sigma))
        assert v[0] == 0.0
        for value, slope in ((x, v), (v, a)):
            error = np.gradient(value, truth.step) - slope
            assert np.abs(error[1:-1]).max() < 1e-2 * np.abs(slope).max()
    before = [part[:lead] for part in motion.series]
    assert before[0] == pytest.approx(np.tile(truth.position[0], (lead, 1)))
    assert not before[1].any()
    assert not before[2].any()
    assert np.rad2deg(make_truth(config, 0, 4.0).truth.position[0, 3]) == pytest.approx(4.0)
