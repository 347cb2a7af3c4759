"""PASSIVE_OBSERVER against an independent integration; what it and other simple schemes share."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from linear_records import STEP, make, run, tune
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from sine_records import find_lag, report

from owtsweep.estimation.passive_observer import choose_gains, find_growth, observe
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.schemes.positions_alone import (
    ABOVE,
    FASTEST,
    balance_lag_and_noise,
    find_waves,
)

NAMES = ("LOWPASS", "COMPLEMENTARY", "PASSIVE_OBSERVER")
_, SETTING, _ = make()


# PASSIVE_OBSERVER: frequencies of the six degrees of freedom, in rad/s.

NATURAL = np.array([0.16, 0.17, 0.3, 0.25, 0.2, 0.12])
WAVES = np.array([0.6, 0.55, 0.9, 0.8, 0.7, 0.5])
GAINS = choose_gains(NATURAL, WAVES, 3.0 * WAVES)
DAMPING = np.full(6, 0.05)


def integrate(y, duration, start):
    """Return position and velocity by the docstring's equations, and the times, per degree."""

    def turn(yaw):
        c, s = np.cos(yaw), np.sin(yaw)
        full = np.eye(6)
        full[:2, :2] = [[c, -s], [s, c]]
        return full

    def slopes(t, state):
        xi1, xi2, eta, b, nu = state.reshape(5, 6)
        k11, k12, k2, k3, k4 = GAINS
        e = y(t) - eta - xi2
        R = turn(y(t)[5])
        return np.concatenate([
            xi2 + k11 * e,
            -(WAVES**2) * xi1 - 2.0 * 0.1 * WAVES * xi2 + k12 * e,
            R @ nu + k2 * e,
            k3 * e,
            -2.0 * DAMPING * NATURAL * nu + R.T @ (-(NATURAL**2) * eta + b + k4 * e),
        ])  # fmt: skip

    begin = np.concatenate([np.zeros(12), start, NATURAL**2 * start, np.zeros(6)])
    times = np.linspace(0.0, duration, 41)
    solved = solve_ivp(slopes, (0.0, duration), begin, "LSODA", times, rtol=1e-10, atol=1e-12)
    states = solved.y.T.reshape(-1, 5, 6)
    position = states[:, 2] + states[:, 1]
    slow = np.stack([turn(y(t)[5]) @ s[4] for t, s in zip(times, states, strict=True)])
    return position, slow - WAVES**2 * states[:, 0] - 0.2 * WAVES * states[:, 1]


def watch(reported, step, start=None):
    found = np.empty_like(reported), np.empty_like(reported)
    start = reported[0].copy() if start is None else start
    observe(reported, step, NATURAL, DAMPING, WAVES, GAINS, start, found)
    return found


def test_the_observer_solves_its_equations_to_the_order_of_the_step() -> None:
    """With yaw to and fro by a radian, so that surge and sway turn."""
    phase, size = np.arange(6.0), np.array([2.0, 1.0, 0.5, 0.1, 0.2, 1.0])

    def y(t):
        return size * np.sin(0.3 * t + phase) + 0.3 * size * np.cos(0.8 * t)

    wanted = integrate(y, 40.0, y(0.0))
    off = []
    for step in (0.02, 0.01, 0.005):
        times = step * np.arange(round(40.0 / step) + 1)
        found = watch(np.stack([y(t) for t in times]), step)
        every = round(1.0 / step)
        off.append([np.abs(f[::every] - w).max() for f, w in zip(found, wanted, strict=True)])
    ratios = np.array(off[:-1]) / np.array(off[1:])
    assert ratios == pytest.approx(2.0, rel=0.1)
    assert max(off[-1]) < 0.02


def test_gains_put_the_waves_error_where_fossen_puts_it() -> None:
    """Without the slow motion's loop: a notch of damping 1 at w0, and the cut-off (h0 of MSS)."""
    gains = GAINS.copy()
    gains[3:] = 0.0
    for i in range(6):
        modes = np.linalg.eigvals(matrix_of(i, np.full(6, 1e-9), np.zeros(6), WAVES, gains))
        wanted = np.array([-3.0 * WAVES[i], -WAVES[i], -WAVES[i], 0.0, 0.0])
        assert np.sort(modes.real) == pytest.approx(wanted, abs=1e-4)  # a double root: sqrt(eps)
    k11, k12, k2, k3, k4 = GAINS
    assert k11 == pytest.approx(-2.0 * 0.9 * 3.0)
    assert k12 == pytest.approx(2.0 * 0.9 * WAVES)
    assert k2 == pytest.approx(3.0 * WAVES)
    assert np.all(k3 / k4 < WAVES)
    assert np.all(k2 > WAVES)


def test_modes_are_those_of_the_kernels_own_decay() -> None:
    """A position that is left alone decays as the modes say, to the order of the step."""
    for i in (0, 3):
        off = []
        for step in (0.02, 0.01):
            steps = round(60.0 / step)
            start = np.zeros(6)
            start[i] = 1.0
            found = watch(np.zeros((steps, 6)), step, start)[0][:, i]
            modes = np.linalg.eigvals(matrix_of(i))
            # Coefficients by least squares: only the rates are compared.
            basis = np.exp(modes * step * np.arange(steps)[:, None])
            fit = basis @ np.linalg.lstsq(basis, found.astype(complex), rcond=None)[0]
            off.append(np.abs(fit - found).max())
        assert off[0] / off[1] == pytest.approx(2.0, rel=0.25)
        assert off[1] < 0.01
        assert modes.real.max() < 0.0
        later = 30.0
        state = np.array([0.0, 0.0, 1.0, NATURAL[i] ** 2, 0.0])
        wanted = expm(later * matrix_of(i)) @ state
        assert found[round(later / 0.01)] == pytest.approx(wanted[1] + wanted[2], abs=0.01)


def matrix_of(i, natural=NATURAL, damping=DAMPING, waves=WAVES, gains=GAINS):
    """Return d state' / d state of the docstring's equations with y = 0, for degree of freedom i.

    The real parts of its eigenvalues are to be below 0.
    """
    k11, k12, k2, k3, k4 = gains[:, i]
    e = np.array([0.0, -1.0, -1.0, 0.0, 0.0])  # xi_1, xi_2, eta, b, nu
    one = np.eye(5)
    return np.stack([
        one[1] + k11 * e,
        -(waves[i] ** 2) * one[0] - 0.2 * waves[i] * one[1] + k12 * e,
        one[4] + k2 * e,
        k3 * e,
        -(natural[i] ** 2) * one[2] + one[3] - 2.0 * damping[i] * natural[i] * one[4] + k4 * e,
    ])  # fmt: skip


def test_the_observer_settles_to_a_mean() -> None:
    setting = replace(SETTING, frequency=NATURAL)
    resting = run("PASSIVE_OBSERVER", setting, report(np.full(20000, 8.5)))
    assert resting.position == pytest.approx(8.5)
    assert resting.velocity == pytest.approx(0.0, abs=1e-9)
    moved = np.where(np.arange(20000) < 100, 3.0, 8.5)  # it begins with another mean
    settled = run("PASSIVE_OBSERVER", setting, report(moved))
    assert settled.position[-1] == pytest.approx(8.5, rel=2e-3)
    assert settled.velocity[-1] == pytest.approx(0.0, abs=0.02)


def test_the_observer_follows_sines_as_its_transfer_function_says() -> None:
    """Slow ones and those of waves at their size; far above the cut-off little is left."""
    step = 0.005
    pick = np.array([0.0, 1.0, 1.0, 0.0, 0.0])  # xi_2 + eta
    for i, omega, least, most in ((0, 0.1, 0.9, 1.1), (0, 0.6, 0.9, 1.1), (2, 9.0, 0.3, 0.6)):
        time = step * np.arange(round(24.0 * np.pi / omega / step) * 4)
        wave = np.sin(omega * time)
        found = np.zeros((len(time), 6))
        found[:, i] = wave
        position, velocity = watch(found, step)
        states = np.linalg.solve(1j * omega * np.eye(5) - matrix_of(i), GAINS[:, i])
        response = pick @ states
        lag, size = find_lag(position[:, i], wave, omega, step=step)
        assert size == pytest.approx(abs(response), abs=0.01)
        assert lag * omega == pytest.approx(-np.angle(response), abs=0.01 + step * omega)
        assert least < size < most
        speed = states[4] - WAVES[i] ** 2 * states[0] - 0.2 * WAVES[i] * states[1]
        lag, size = find_lag(velocity[:, i], wave, omega, step=step)
        assert size == pytest.approx(abs(speed), rel=0.02)


def test_who_has_no_report_coasts() -> None:
    """Inside a gap the observer is its model without innovations, the low-pass holds the last."""
    time = STEP * np.arange(3000)
    position = np.repeat(8.5 + np.sin(0.3 * time)[:, None], 6, axis=1)
    gap = position.copy()
    gap[2000:2200] = np.nan
    for name in NAMES:
        found = run(name, SETTING, report(gap))
        assert np.isfinite(found.position).all()
        whole = run(name, SETTING, report(position))
        assert found.position[:2000] == pytest.approx(whole.position[:2000], rel=1e-12)
        assert np.abs(found.position[2150] - whole.position[2150]).max() > 0.01
    found = run("LOWPASS", SETTING, report(gap))
    assert found.position[2199] == pytest.approx(position[1999], abs=5e-3)
    # The observer began at rest where the mean load holds it, and nothing tells it otherwise.
    reported = np.full((4000, 6), np.nan)
    start = np.array([1.0, 2.0, 0.5, 0.1, 0.1, 0.0])
    position, velocity = watch(reported, STEP, start)
    assert position == pytest.approx(np.tile(start, (4000, 1)))
    assert velocity == pytest.approx(np.zeros((4000, 6)), abs=1e-9)


def test_growth_is_that_of_the_kernels_own_steps() -> None:
    """Steps may be too long where the observer is stable: a light buoy, w0 near wn."""
    natural = np.array([4.8, 0.16, 0.6, 4.8, 0.2, 0.12])
    waves = np.array([5.8, 0.6, 4.4, 4.9, 0.7, 0.5])
    gains = choose_gains(natural, waves, 3.0 * waves)
    told = []
    for step in (0.02, 0.05, 0.07, 0.08):
        reported = np.zeros((2000, 6))
        found = np.empty_like(reported), np.empty_like(reported)
        start = np.array([0.0, 0.0, 1.0, 1.0, 1.0, 0.0])
        observe(reported, step, natural, DAMPING, waves, gains, start, found)
        for i in (2, 3, 4):
            growth = find_growth(natural[i], 0.05, waves[i], gains[:, i], step)
            told.append(growth < 1.0)
            modes = np.linalg.eigvals(matrix_of(i, natural, DAMPING, waves, gains))
            assert modes.real.max() < 0.0
            sizes = [np.abs(found[0][k : k + 200, i]).max() for k in (400, 1000)]
            measured = (sizes[1] / sizes[0]) ** (1.0 / 600.0) if sizes[1] > 1e-30 else growth
            assert measured == pytest.approx(growth, abs=2e-3)
    assert 6 < sum(told) < 12


def test_an_observer_that_cannot_run_says_so() -> None:
    setting = replace(SETTING, step=2.0)
    with pytest.raises(
        Unable, match=r"PASSIVE_OBSERVER is unstable in x at 0\.5 Hz: .* record\.rate"
    ):
        SCHEMES.resolve("PASSIVE_OBSERVER").prepare(setting)
    chosen = SCHEMES.resolve("PASSIVE_OBSERVER").prepare(SETTING)
    waves = find_waves(SETTING)
    assert np.all(waves >= SETTING.frequency)
    cutoff = np.clip(balance_lag_and_noise(SETTING), ABOVE * waves, FASTEST / SETTING.step)
    (gains,) = chosen.function.args
    assert gains == pytest.approx(choose_gains(SETTING.frequency, waves, cutoff))


@pytest.mark.parametrize("name", NAMES)
def test_who_is_told_of_losses_leaves_zeros_out(name: str) -> None:
    position = 8.5 + np.sin(0.3 * STEP * np.arange(2000))
    lost = np.zeros(2000, dtype=bool)
    lost[1000:1010] = True
    zeros = replace(report(np.where(lost, 0.0, position)), lost=lost)
    gap = report(np.where(lost, np.nan, position))
    told = run(name, SETTING, zeros)
    assert np.array_equal(told.position, run(name, SETTING, gap).position)
    blind = run(name, replace(SETTING, tuning=tune(losses="as_printed")), zeros)
    assert np.abs(blind.position - told.position).max() > 0.2
