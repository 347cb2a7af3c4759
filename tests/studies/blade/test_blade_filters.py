"""The filters of the inertial unit by brute force: differences, least squares, noiseless runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hanging import QUIET, make, mean_square, run, score
from scipy.linalg import solve_discrete_lyapunov
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from owtsweep.estimation.inertial import (
    ERRORS,
    STATES,
    add_noise,
    carry,
    correct,
    lean,
    linearise,
    move,
    place,
    subtract,
)
from owtsweep.estimation.inertial_invariant import carry_body, correct_body
from owtsweep.studies.blade.contract import PLAN, ROOT
from owtsweep.studies.blade.schemes.mekf import Navigator, describe_swing
from owtsweep.studies.blade.schemes.navigation import begin, find_noise

RNG = np.random.default_rng(5)
STEP = 0.02
ALIKE = ("UKF", "MEKF", "INVARIANT_EKF")


def draw_state():
    """Return a state that is anywhere."""
    s = RNG.normal(size=STATES)
    s[6:10] = Rotation.random(random_state=7).as_quat(scalar_first=True)
    s[10:] *= 0.1
    return s


def test_errors_put_in_are_those_that_come_out() -> None:
    base, dx = draw_state(), 0.3 * RNG.normal(size=ERRORS)
    s, found = base.copy(), np.empty(ERRORS)
    correct(s, dx)
    subtract(s, base, found)
    assert found == pytest.approx(dx, abs=1e-14)
    s[6:10] *= -1.0  # the same attitude
    subtract(s, base, found)
    assert found == pytest.approx(dx, abs=1e-14)


@pytest.mark.parametrize("step", [0.02, 0.002])
def test_errors_move_as_states_do(step: float) -> None:
    """By central differences; what is left out is of the second order of the step."""
    s = draw_state()
    f, w = RNG.normal(size=(2, 3)) * 5.0, RNG.normal(size=(2, 3)) * 0.3
    moved = s.copy()
    move(moved, step, f[0], w[0], f[1], w[1])
    M, R, back = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    linearise(s, moved, step, f[0], f[1], M, R, back)
    F, numeric, h = np.eye(ERRORS), np.empty((ERRORS, ERRORS)), 1e-5
    carry(F, step, M, R, back)
    for j in range(ERRORS):
        ends = []
        for sign in (1.0, -1.0):
            near, found = s.copy(), np.empty(ERRORS)
            correct(near, sign * h * np.eye(ERRORS)[j])
            move(near, step, f[0], w[0], f[1], w[1])
            subtract(near, moved, found)
            ends.append(found)
        numeric[:, j] = (ends[0] - ends[1]) / (2.0 * h)
    assert np.abs(F - numeric).max() < 6.0 * step**2


def test_errors_in_the_bodys_frame_move_as_states_do() -> None:
    s, step, h = draw_state(), 0.002, 1e-5
    f, w = RNG.normal(size=3) * 5.0, RNG.normal(size=3) * 0.3
    moved = s.copy()
    move(moved, step, f, w, f, w)
    old, new = (
        Rotation.from_quat(each[6:10], scalar_first=True).as_matrix() for each in (s, moved)
    )
    F, numeric = np.eye(ERRORS), np.empty((ERRORS, ERRORS))
    carry_body(F, step, f - s[10:13], new.T @ old)
    turn = np.eye(ERRORS)
    turn[:3, :3] = turn[3:6, 3:6] = new.T
    for j in range(ERRORS):
        ends = []
        for sign in (1.0, -1.0):
            near, found = s.copy(), np.empty(ERRORS)
            correct_body(near, sign * h * np.eye(ERRORS)[j])
            move(near, step, f, w, f, w)
            subtract(near, moved, found)
            ends.append(turn @ found)
        numeric[:, j] = (ends[0] - ends[1]) / (2.0 * h)
    assert np.abs(F - numeric).max() < 1e-4


def test_an_antenna_moves_with_the_attitude_as_its_row_says() -> None:
    s, lever, h = draw_state(), np.array([-2.0, 0.5, 1.0]), 1e-6
    R = Rotation.from_quat(s[6:10], scalar_first=True).as_matrix()
    H, at, numeric = np.empty((3, 3)), np.empty(3), np.empty((3, 3))
    lean(R, lever, H)
    place(s, R, lever, at)
    for j in range(3):
        near, there = s.copy(), np.empty(3)
        correct(near, h * np.eye(ERRORS)[6 + j])
        place(near, Rotation.from_quat(near[6:10], scalar_first=True).as_matrix(), lever, there)
        numeric[:, j] = (there - at) / h
    assert pytest.approx(numeric, abs=1e-5) == H


@pytest.mark.parametrize("name", [*ALIKE, "MEKF_HEADING", "MEKF_OFFSET", "FIXED_LAG", "SMOOTHER"])
def test_without_noise_the_truth_comes_back(name: str) -> None:
    found = score(name, *QUIET)
    assert found["root"] < 1e-5
    assert found["velocity"] < 2e-5
    assert found["attitude"] < 1e-4


@pytest.mark.parametrize(("name", "root"), [("GNSS_WAHBA", 0.02), ("TOTAL_STATIONS", 0.02)])
def test_geometry_alone_is_only_late_or_interpolated(name: str, root: float) -> None:
    """At the samples of fixes the three antennas give the truth."""
    _, motion, measured, setting = make(*QUIET)
    error = np.abs(run(name, setting, measured).root - motion.truth.root)
    assert error.max() < 0.2
    if name == "GNSS_WAHBA":
        assert error[measured.due].max() < 1e-5
    assert np.sqrt(np.mean(error**2)) < root


def test_the_smoother_is_the_least_squares_of_everything() -> None:
    """A batch over 30 samples: the start, what moves states, and fixes are its residuals."""
    _, _, measured, setting = make()
    steps = 30
    short = replace(
        measured,
        **{
            name: getattr(measured, name)[:steps]
            for name in ("specific_force", "rate", "fixes", "due")
        },
    )
    navigator = Navigator(setting)
    first, P = begin(setting)
    states = navigator.filter(short).states
    Q = np.zeros((ERRORS, ERRORS))
    add_noise(Q, STEP, find_noise(setting))
    whiten_start, whiten = (np.linalg.inv(np.linalg.cholesky(each)) for each in (P, Q))
    f, w = short.specific_force, short.rate

    def residuals(flat):
        now = states.copy()
        for s, dx in zip(now, flat.reshape(steps, ERRORS), strict=True):
            correct(s, np.ascontiguousarray(dx))
        dx, parts = np.empty(ERRORS), []
        subtract(now[0], first, dx)
        parts.append(whiten_start @ dx)
        for k in range(steps - 1):
            moved = now[k].copy()
            move(moved, STEP, f[k], w[k], f[k + 1], w[k + 1])
            subtract(now[k + 1], moved, dx)
            parts.append(whiten @ dx)
        for k in np.flatnonzero(short.due):
            R, at = Rotation.from_quat(now[k, 6:10], scalar_first=True).as_matrix(), np.empty(3)
            place(now[k], R, PLAN.levers[0], at)
            parts.append((short.fixes[k, 0] - at) / setting.fix_sigma)
        return np.concatenate(parts)

    # scaled by the start's standard deviations, so that the unknowns are of one size
    scale = np.tile(np.sqrt(np.diag(P)), steps)
    best = least_squares(lambda x: residuals(scale * x), np.zeros(steps * ERRORS), method="lm")
    smoothed = run("SMOOTHER", setting, short)
    lag = run("FIXED_LAG", replace(setting, tuning=setting.tuning.model_copy(update={"lag": 9.0})),
              short)  # fmt: skip
    information = best.jac.T @ best.jac
    covariance = np.linalg.inv(information) * np.outer(scale, scale)
    for k in (0, 7, 29):
        s = states[k].copy()
        correct(s, np.ascontiguousarray((scale * best.x).reshape(steps, ERRORS)[k]))
        R = Rotation.from_quat(s[6:10], scalar_first=True).as_matrix()
        size = np.sqrt(np.diag(smoothed.root_covariance[k]))
        root = s[:3] + R @ (np.array([-17.93, 0.0, 0.0]) - np.array([-16.0, 0.0, 1.6]))
        assert np.abs(smoothed.root[k] - root).max() < 2e-3 * size.max()
        assert np.abs(lag.root[k] - smoothed.root[k]).max() < 1e-12
        block = slice(ERRORS * k + 6, ERRORS * k + 9)
        assert smoothed.attitude_covariance[k] == pytest.approx(covariance[block, block], rel=0.01)


def test_three_filters_of_the_same_errors_agree() -> None:
    found = {name: score(name) for name in ALIKE}
    for name in ("MEKF", "INVARIANT_EKF"):
        for measure in ("root", "velocity", "attitude"):
            assert found[name][measure] == pytest.approx(found["UKF"][measure], rel=0.02)


@pytest.mark.parametrize("name", ["UKF", "MEKF", "INVARIANT_EKF", "MEKF_HEADING", "SMOOTHER"])
def test_filters_know_their_errors(name: str) -> None:
    """Over four records; goals are judged over more by experiments/maes2018."""
    found = [score(name, replicate=replicate) for replicate in range(4)]
    assert np.mean([each["nis"] for each in found]) == pytest.approx(1.0, abs=0.08)
    assert np.mean([each["nees"] for each in found]) == pytest.approx(1.0, abs=0.35)
    for axis in "xyz":
        ratio = mean_square(found, f"rms_over_p_{axis}")
        assert ratio == pytest.approx(1.0, abs=0.25)


def test_a_late_clock_is_found_by_who_has_it_as_a_state() -> None:
    _, _, measured, setting = make("grid.offset=[0.1]")
    navigator = Navigator(setting, offset=True)
    offsets = navigator.filter(measured).states[:, STATES]
    assert offsets[-1] == pytest.approx(0.1, abs=0.01)
    late = {name: score(name, "grid.offset=[0.1]")["root"] for name in ("MEKF", "MEKF_OFFSET")}
    assert late["MEKF_OFFSET"] < 0.3 * late["MEKF"]


def test_who_knows_the_hook_does_not_drift_away() -> None:
    """Tactical grade, 40 s without GNSS: better than coasting and than holding, and it knows it."""
    words = ("grid.outage=[40]", "unit=tactical", "sensors.outage_every=60")
    found = {
        name: [score(name, *words, replicate=replicate) for replicate in range(4)]
        for name in ("PENDULUM", "MEKF", "HOLD")
    }
    worst = {name: mean_square(each, "worst") for name, each in found.items()}
    assert worst["PENDULUM"] < 0.7 * min(worst["MEKF"], worst["HOLD"])
    assert 0.5 < np.mean([each["nees"] for each in found["PENDULUM"]]) < 1.6


def test_the_swing_begins_under_the_hook_and_keeps_its_size() -> None:
    """Turned as at the start, the point under the hook is the centre of gravity of the truth."""
    _, motion, _, setting = make(*QUIET)
    size = ERRORS + 9
    s, P = np.zeros(size + 1), np.zeros((size, size))
    transitions, noises = describe_swing(setting, s, P, ERRORS)
    first = motion.truth.root[0] - motion.truth.rotation[0] @ ROOT
    assert s[ERRORS + 7 : ERRORS + 10] == pytest.approx(first, abs=1e-4)
    for F, Q, period, sigma in zip(
        transitions, noises, setting.swing_period, setting.swing_sigma, strict=True
    ):
        settled = solve_discrete_lyapunov(F, Q[:2, :2])
        rates = (2.0 * np.pi / period) ** 2
        assert settled == pytest.approx(sigma**2 * np.diag([1.0, rates]), abs=1e-12)


def test_before_the_first_fix_the_start_stands() -> None:
    _, motion, measured, setting = make(*QUIET)
    blind = replace(measured, fixes=np.full_like(measured.fixes, np.nan))
    for name in ("HOLD", "GNSS_WAHBA"):
        found = run(name, setting, blind)
        assert found.root[-1] == pytest.approx(motion.truth.root[0], abs=1e-5)
    coasting = run("MEKF", setting, blind)
    assert coasting.root[:500] == pytest.approx(motion.truth.root[:500], abs=1e-3)
    assert np.isnan(coasting.nis).all()
