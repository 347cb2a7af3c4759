"""What the floater study's Kalman filters know of their errors, losses, delays and sensors."""

from dataclasses import replace

import numpy as np
import pytest
from linear_records import (
    STEP,
    continuous,
    errors,
    lose,
    losses,
    make,
    nees,
    rms,
    run,
    tune,
)
from scipy.linalg import expm, solve_discrete_are, solve_discrete_lyapunov
from scipy.spatial.transform import Rotation

from owtsweep.estimation.kinematic import Noise
from owtsweep.estimation.kinematic_predictor import make_transition
from owtsweep.gravity import GRAVITY
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.schemes.linear import read_inputs
from owtsweep.studies.floater.schemes.printed import process_noise

LINEAR = ["KF_STEADY", "KF", "KF_CONSISTENT", "KF_BIAS", "KF_DELAY", "KF_REPAIRED", "FIXED_LAG"]
CONSISTENT = LINEAR[2:]


def test_time_varying_settles_at_steady():
    _, setting, measured = make(steps=3000)
    varying, steady = (run(name, setting, measured) for name in ("KF", "KF_STEADY"))
    assert np.allclose(varying.covariance[1000:], steady.covariance, rtol=0.02, atol=0.0)
    assert np.allclose(varying.covariance[-1], steady.covariance[0], rtol=1e-4, atol=0.0)
    truth = make(steps=3000)[0]
    ratio = rms(errors(truth, varying)) / rms(errors(truth, steady))
    assert np.all(np.abs(ratio - 1.0) < 0.02)


def test_exact_compensation_costs_the_prediction_only():
    delay, ratios = 6.5, []
    for seed in range(10):
        truth, setting, measured = make(seed, delay=delay * STEP)
        late = run("KF_DELAY", setting, measured)
        believed = late.covariance[-1][:, [0, 1], [0, 1]]
        ratios.append(rms(errors(truth, late)) / np.sqrt(believed))
    assert np.all(np.abs(rms(np.array(ratios)) - 1.0) < 0.1)
    assert rms(np.ravel(ratios)) == pytest.approx(1.0, abs=0.03)
    # Without delay, and then predicted: its covariance goes on by the process noise alone.
    in_time = run("KF_CONSISTENT", setting, measured)
    for column in range(3):
        noise = Noise(setting.acceleration_sigma[column] ** 2 * STEP, 0.0, 1.0, 1.0)
        F, _, _, Q = continuous(noise, delay * STEP)
        P = np.zeros((3, 3))
        P[:2, :2] = in_time.covariance[-1, column]
        predicted = (F @ P @ F.T + Q)[:2, :2]
        assert np.allclose(late.covariance[-1, column], predicted, rtol=1e-3)


def test_noiseless_late_reports_are_compensated():
    truth, setting, measured = make(snr=40.0, delay=2.4 * STEP, noisy=False)
    late = errors(truth, run("KF_CONSISTENT", setting, measured))
    known = errors(truth, run("KF_DELAY", setting, measured))
    assert np.all(rms(known) < 0.01 * rms(late))


def test_ignored_delay_costs_what_the_closed_loop_says():
    delay = 3.0 * STEP
    truth, setting, measured = make(delay=delay, noisy=False)
    found = run("KF_CONSISTENT", setting, measured)
    spectrum = np.fft.rfft(truth.position[:, :3] * np.hanning(len(truth.position))[:, None], axis=0)
    omega = 2.0 * np.pi * np.fft.rfftfreq(len(truth.position), STEP)
    for c in range(3):
        P = found.covariance[-1, c]
        K = P[:, 0] / setting.position_sigma[c] ** 2
        F = make_transition(STEP)
        loop = (np.eye(2) - np.outer(K, [1.0, 0.0])) @ F
        z = np.exp(1j * omega * STEP)
        T = np.array([(np.linalg.solve(np.eye(2) - loop / at, K))[0] for at in z])
        power = np.abs(spectrum[:, c]) ** 2
        cost = np.sum(np.abs(T * (np.exp(-1j * omega * delay) - 1.0)) ** 2 * power) / power.sum()
        shown = np.hanning(len(truth.position)) * (found.position - truth.position)[:, c]
        size = np.hanning(len(truth.position)) * truth.position[:, c]
        assert rms(shown) / rms(size) == pytest.approx(np.sqrt(cost), rel=0.05)


@pytest.mark.parametrize("name", CONSISTENT)
def test_consistent_filters_know_their_errors(name):
    """Each is given all errors that it has states for."""
    bias = 0.03 if name in {"KF_BIAS", "KF_REPAIRED", "FIXED_LAG"} else 0.0
    delay = 0.05 if name in {"KF_DELAY", "KF_REPAIRED", "FIXED_LAG"} else 0.0
    found, sizes, innovations = [], [], []
    for seed in range(12):
        snr = (10.0, 20.0, 40.0)[seed % 3]
        truth, setting, measured = make(seed, snr=snr, bias=bias, delay=delay)
        estimates = run(name, setting, measured)
        error = errors(truth, estimates)
        found.append(nees(error, estimates.covariance))
        sizes.append(rms(error)[:, 0] ** 2 / estimates.covariance[1000:, :, 0, 0].mean(axis=0))
        innovations.append(np.nanmean(estimates.nis[1000:], axis=0))
    assert np.mean(found) == pytest.approx(1.0, abs=0.05)
    assert np.all(np.abs(np.sqrt(np.mean(sizes, axis=0)) - 1.0) < 0.1)
    assert np.mean(innovations) == pytest.approx(1.0, abs=0.02)


def test_variance_believed_ten_times_too_large_costs_little():
    """A rms of 1.35 in position, by the Lyapunov equation; `believed` holds for rates, too."""
    told, wrong = [], []
    for seed in range(10):
        truth, setting, measured = make(seed)
        larger = replace(
            setting,
            position_sigma=setting.position_sigma * np.sqrt(10.0),
            rate_sigma=setting.rate_sigma * np.sqrt(10.0),
        )
        told.append(rms(errors(truth, run("KF_CONSISTENT", setting, measured))))
        wrong.append(rms(errors(truth, run("KF_CONSISTENT", larger, measured))))
    ratio = np.mean(rms(np.array(wrong))[:, 0] / rms(np.array(told))[:, 0])
    c = 0
    noise = Noise(setting.acceleration_sigma[c] ** 2 * STEP, 0.0, 1.0, 1.0)
    F, _, _, Q = continuous(noise, STEP)
    F, Q, H, R = F[:2, :2], Q[:2, :2], np.eye(2)[:1], setting.position_sigma[c] ** 2
    sizes = []
    for believed in (R, 10.0 * R):
        M = solve_discrete_are(F.T, H.T, Q, [[believed]])
        K = M[:, :1] / (M[0, 0] + believed)
        L = np.eye(2) - K @ H
        sizes.append(solve_discrete_lyapunov(L @ F, L @ Q @ L.T + R * K @ K.T)[0, 0])
    expected = np.sqrt(sizes[1] / sizes[0])
    assert 1.3 < expected < 1.4
    assert ratio == pytest.approx(expected, rel=0.05)


def bursts(steps):
    """Return four losses of half a second."""
    lost = np.zeros(steps, dtype=bool)
    for start in range(1200, steps, 700):
        lost[start : start + 10] = True
    return lost


@pytest.mark.parametrize("name", ["KF_STEADY", "KF", "KF_CONSISTENT"])
def test_losses_known_cost_little_and_blind_zeros_much(name):
    found = []
    for seed in range(5):
        truth, setting, measured = make(seed, mean=2.5)
        lost = lose(measured, bursts(len(measured.age)), zeros=True)
        blind = replace(setting, tuning=tune(losses="as_printed"))
        cases = [(setting, measured), (setting, lost), (blind, lost)]
        found.append([rms(errors(truth, run(name, *case)))[:, 0] for case in cases])
    whole, known, zeros = rms(np.array(found))
    assert np.all(known < 1.05 * whole)
    if name == "KF":  # looks for zeros itself
        assert np.all(zeros < 1.05 * whole)
        assert np.allclose(zeros[:3], known[:3], rtol=1e-9)
        assert np.all(zeros[3:] != known[3:])  # R is that of the rates, too
    else:
        assert np.all(zeros > 4.0 * whole)


def test_bias_as_a_state_takes_the_bias_away():
    truth, setting, measured = make(bias=0.3)
    plain, bias = (
        rms(errors(truth, run(name, setting, measured))) for name in ("KF_CONSISTENT", "KF_BIAS")
    )
    assert np.all(bias[:3] < 0.2 * plain[:3])
    untold = replace(setting, bias_sigma=np.zeros(6))
    same = run("KF_BIAS", untold, measured).position
    assert np.allclose(same, run("KF_CONSISTENT", setting, measured).position, rtol=0, atol=1e-12)


def test_who_is_told_no_delay_takes_ages_for_zero():
    _, setting, measured = make(steps=500, delay=0.1)
    untold = replace(setting, delay=0.0, tuning=tune(delay="ignored"))
    assert np.array_equal(
        run("KF_DELAY", untold, measured).position,
        run("KF_CONSISTENT", setting, measured).position,
    )
    declared = replace(setting, delay=0.1, tuning=tune(delay="declared", delay_declared=0.1))
    told = run("KF_DELAY", setting, measured).position
    assert np.array_equal(run("KF_DELAY", declared, measured).position, told)


@pytest.mark.parametrize("name", ["KF_DELAY", "KF_REPAIRED", "FIXED_LAG"])
def test_irregular_reports_are_taken_at_the_times_they_show(name):
    """Some arrive before those of earlier times, and some show a time after their arrival."""
    found = []
    for seed in range(8):
        truth, setting, measured = make(seed, delay=0.02, jitter=0.4)
        estimates = run(name, setting, measured)
        found.append(nees(errors(truth, estimates), estimates.covariance))
    assert np.mean(found) == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("name", LINEAR)
def test_every_scheme_keeps_the_contract(name):
    _, setting, measured = make(steps=300, delay=0.1)
    measured = lose(measured, losses(300, np.random.default_rng(0)), zeros=False)
    kept = measured.position.copy()
    scheme = SCHEMES.resolve(name)
    assert scheme.name == name
    estimates = scheme.prepare(setting).run(measured)
    assert np.array_equal(measured.position, kept, equal_nan=True)
    assert estimates.position.shape == estimates.velocity.shape == estimates.nis.shape == (300, 6)
    assert estimates.covariance.shape in {(300, 6, 2, 2), (1, 6, 2, 2)}
    for array in (estimates.position, estimates.velocity, estimates.covariance):
        assert np.all(np.isfinite(array))
    assert np.all(np.linalg.eigvalsh(estimates.covariance) > 0.0)
    assert np.all(np.isnan(estimates.nis[measured.lost]))


@pytest.mark.parametrize("name", LINEAR)
def test_a_record_without_reports_gives_the_prior(name):
    _, setting, measured = make(steps=50)
    estimates = run(name, setting, lose(measured, np.ones(50, dtype=bool), zeros=False))
    assert np.all(np.isfinite(estimates.position))
    assert np.all(np.isnan(estimates.nis))


def test_steady_state_needs_noise_of_accelerations():
    _, setting, _ = make(steps=50)
    with pytest.raises(Unable, match="no noise"):
        SCHEMES.resolve("KF_STEADY").prepare(replace(setting, acceleration_sigma=np.zeros(6)))


def test_body_rates_are_turned_to_those_of_euler_angles():
    """Eq. (2), against a rotation matrix that is differentiated by finite differences."""
    _, setting, measured = make(steps=5)
    angles, rates = np.array([0.3, -0.4, 0.9]), np.array([0.2, 0.1, -0.3])

    def rotation(phi, theta, psi):
        def about(i, angle):
            spin = np.zeros((3, 3))
            spin[(i + 1) % 3, (i + 2) % 3], spin[(i + 2) % 3, (i + 1) % 3] = -angle, angle
            return expm(spin)

        return about(2, psi) @ about(1, theta) @ about(0, phi)

    d = 1e-6
    change = (rotation(*(angles + d * rates)) - rotation(*(angles - d * rates))) / (2.0 * d)
    spin = rotation(*angles).T @ change
    body = np.array([spin[2, 1], spin[0, 2], spin[1, 0]])
    reported = np.tile(np.concatenate([np.zeros(3), angles]), (5, 1))
    reported[3] = 0.0
    measured = replace(
        measured, position=reported, rate=np.tile(body, (5, 1)), specific_force=np.zeros((5, 3)),
        lost=np.array([False, False, False, True, False]), acceleration=None,
    )  # fmt: skip
    found = read_inputs(replace(setting, tuning=tune(losses="known")), measured).rate
    assert np.allclose(np.column_stack(found[3:]), rates, atol=1e-8)


def on_body(setting, measured, truth, seed):
    """Return setting and measurements with accelerometers and gyros fixed to the body."""
    rng = np.random.default_rng([seed, 2])
    turns = Rotation.from_euler("ZYX", truth.position[:, :2:-1])
    force = turns.apply(truth.acceleration[:, :3] - [0.0, 0.0, GRAVITY], inverse=True)
    (phi, theta, _), change = truth.position[:, 3:].T, truth.velocity[:, 3:].T
    rate = np.column_stack([
        change[0] - np.sin(theta) * change[2],
        np.cos(phi) * change[1] + np.sin(phi) * np.cos(theta) * change[2],
        np.cos(phi) * np.cos(theta) * change[2] - np.sin(phi) * change[1],
    ])  # fmt: skip
    sigma = np.concatenate([setting.acceleration_sigma[:3], setting.motion_sigma[2, 3:]])
    measured = replace(
        measured,
        acceleration=None,
        specific_force=force + sigma[:3] * rng.standard_normal(force.shape),
        rate=rate + setting.rate_sigma * rng.standard_normal(rate.shape),
    )
    return replace(setting, body=True, acceleration_sigma=sigma), measured


def test_noise_of_attitude_counts_as_noise_of_levelled_accelerations():
    found, angles = [], []
    for seed in range(10):
        truth, setting, measured = make(seed)
        setting, measured = on_body(setting, measured, truth, seed)
        estimates = run("KF_REPAIRED", setting, measured)
        error = errors(truth, estimates)
        found.append(nees(error, estimates.covariance)[:3])
        angles.append(rms(error)[3:, 0] / setting.position_sigma[3:])
    assert np.mean(found, axis=0) == pytest.approx(np.ones(3), abs=0.12)
    assert np.all(rms(np.array(angles)) < 0.3)


def test_angles_have_no_other_noise_than_their_acceleration_on_the_body():
    truth, setting, measured = make(steps=50, bias=0.1)
    body, _ = on_body(setting, measured, truth, 0)
    Q = process_noise(body)
    h = np.array([STEP**2 / 2.0, STEP])
    assert np.allclose(Q[4], body.acceleration_sigma[4] ** 2 * np.outer(h, h), rtol=1e-9, atol=0.0)
    assert np.linalg.matrix_rank(Q[0]) == 2


def test_noiseless_irregular_reports_leave_no_error():
    """Also where a report shows a time after its arrival, or before that of the one before."""
    truth, setting, measured = make(snr=40.0, delay=0.01, jitter=0.6, noisy=False)
    assert np.any(measured.age < 0.0)
    assert np.any(np.diff(np.arange(len(measured.age)) * STEP - measured.age) < 0.0)
    ignored = errors(truth, run("KF_CONSISTENT", setting, measured))
    known = errors(truth, run("KF_DELAY", setting, measured))
    assert np.all(rms(known)[:, 0] < 0.01 * rms(ignored)[:, 0])
