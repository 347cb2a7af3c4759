"""The filters of the inertial unit by brute force: differences, least squares, noiseless runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hanging import QUIET, make, mean_square, run, score
from scipy.linalg import solve_discrete_lyapunov
from scipy.optimize import least_squares
from scipy.spatial.transform import Rotation

from owtsweep.estimation.inertial.strapdown import (
    ERRORS,
    GYROSCOPES,
    STATES,
    add_noise,
    correct,
    move,
    place,
    subtract,
)
from owtsweep.studies.blade.contract import PLAN, ROOT
from owtsweep.studies.blade.schemes.mekf import Navigator, describe_swing
from owtsweep.studies.blade.schemes.navigation import begin, find_noise

STEP = 0.02
ALIKE = ("UKF", "MEKF", "INVARIANT_EKF")


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
    """A batch over three fixes: the start, what moves states, and fixes are its residuals."""
    _, _, measured, setting = make()
    steps = 21
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
            mean = 0.5 * (w[k] + w[k + 1])
            move(moved, STEP, f[k], f[k + 1], mean, GYROSCOPES, *np.empty((2, 3, 3)))
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
    for k in (0, 7, 20):
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


def test_covariances_stay_symmetric() -> None:
    """What rounding adds to the skew part no fix takes away: it would grow with the record."""
    _, _, measured, setting = make()
    P = Navigator(setting, 2, offset=True, lever=True, swing=True).filter(measured).covariances
    assert np.array_equal(P, P.transpose(0, 2, 1))


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
    _, motion, measured, setting = make(*QUIET)
    states, covariances, _ = Navigator(setting, swing=True).filter(measured)
    first = motion.truth.root[0] - motion.truth.rotation[0] @ ROOT
    assert states[0, ERRORS + 7 :] == pytest.approx(first, abs=1e-4)
    transitions, noises, sizes = describe_swing(setting)
    assert np.all(np.diagonal(covariances[0])[ERRORS:] <= np.square(sizes))
    for F, Q, mode in zip(transitions, noises, setting.swing, strict=True):
        settled = solve_discrete_lyapunov(F, Q[:2, :2])
        rates = (2.0 * np.pi / mode.period) ** 2
        assert settled == pytest.approx(mode.sigma**2 * np.diag([1.0, rates]), abs=1e-12)


def test_before_the_first_fix_the_start_stands() -> None:
    _, motion, measured, setting = make(*QUIET)
    blind = replace(measured, fixes=np.full_like(measured.fixes, np.nan))
    for name in ("HOLD", "GNSS_WAHBA"):
        found = run(name, setting, blind)
        assert found.root[-1] == pytest.approx(motion.truth.root[0], abs=1e-5)
    coasting = run("MEKF", setting, blind)
    assert coasting.root[:500] == pytest.approx(motion.truth.root[:500], abs=1e-3)
    assert np.isnan(coasting.nis).all()
