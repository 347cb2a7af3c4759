"""The error-state filter: its kernels against rotation matrices, the filter against a dense one."""

from dataclasses import replace

import numpy as np
import pytest
from linear_records import make, tune
from scipy.linalg import expm
from scipy.spatial.transform import Rotation

from owtsweep.estimation import error_state as kernels
from owtsweep.gravity import GRAVITY
from owtsweep.studies import compose
from owtsweep.studies.base.contract import Unable
from owtsweep.studies.floater.attitude import find_body_rates
from owtsweep.studies.floater.contest import CONTEST
from owtsweep.studies.floater.declaration import make_setting
from owtsweep.studies.floater.measures import compare
from owtsweep.studies.floater.measuring import measure
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.truth import make_truth

STEP = 0.05


def cross(v):
    return np.array([[0.0, -v[2], v[1]], [v[2], 0.0, -v[0]], [-v[1], v[0], 0.0]])


def as_rotation(q):
    return Rotation.from_quat(np.roll(q, -1))


def make_case(*words, replicate=0, steps=1200):
    """Return truth, setting and measurements of a record with sensors fixed to the body."""
    config = compose([
        "study=floater", "tuning=matched", "sensors.frame=body", "axes=[snr,loss]",
        "grid.delay=[0]", "grid.bias=[0]", "grid.snr=[20]", "grid.loss=[0]",
        "schemes=[ERROR_STATE]", f"record.duration={steps * STEP}", "record.settling=20", *words,
    ])  # fmt: skip
    (cell,) = CONTEST.list_cells(config)
    motion = make_truth(config, replicate, cell.get("roll"))
    return (
        motion.truth, make_setting(config, motion, cell),
        measure(config, motion, cell, replicate), config.record.settled,
    )  # fmt: skip


def judge(scheme, case):
    truth, setting, measured, settled = case
    estimates = SCHEMES.resolve(scheme).prepare(setting).run(measured)
    return compare(truth, estimates, setting.position_sigma, settled)


def test_quaternions_are_those_of_rotation_matrices():
    rng = np.random.default_rng(1)
    for _ in range(5):
        angles = rng.uniform([-3.0, -1.4, -3.0], [3.0, 1.4, 3.0])
        q, R, found = np.empty(4), np.empty((3, 3)), np.empty(3)
        kernels.find_quaternion(angles, q)
        kernels.rotate(q, R)
        assert np.allclose(R, Rotation.from_euler("ZYX", angles[::-1]).as_matrix(), atol=1e-14)
        kernels.find_angles(q, found)
        assert np.allclose(found, angles, atol=1e-12)
        v = rng.normal(size=3)
        kernels.turn(q, *v)
        kernels.rotate(q, found_R := np.empty((3, 3)))
        assert np.allclose(found_R, R @ expm(cross(v)), atol=1e-13)
        rates, T = rng.normal(size=(1, 3)), np.empty((3, 3))
        kernels.map_rates(angles, T)
        body = find_body_rates(angles[None], rates, "exact")[0]
        assert np.allclose(T @ body, rates[0], atol=1e-10)


def change(s, dx):
    """Return a state with errors put in, by matrices."""
    moved = s.copy()
    moved[:6] += dx[:6]
    turned = (as_rotation(s[6:10]) * Rotation.from_rotvec(dx[6:9])).as_quat()
    moved[6:10] = np.roll(turned, 1)
    moved[10:] += dx[9:]
    return moved


def difference(s, other):
    """Return the errors that turn the state `other` into s."""
    turned = (as_rotation(other[6:10]).inv() * as_rotation(s[6:10])).as_rotvec()
    return np.concatenate([s[:6] - other[:6], turned, s[10:] - other[10:]])


def random_state(rng):
    s = rng.normal(size=16)
    s[6:10] /= np.linalg.norm(s[6:10])
    return s


def test_the_covariance_is_carried_as_errors_are():
    """F P F' + Q with F by finite differences of the prediction, Q by its closed form."""
    rng = np.random.default_rng(2)
    s, d = random_state(rng), 0.002
    first, last = rng.normal(size=(2, 3)) - np.array([0.0, 0.0, GRAVITY])
    noise = rng.uniform(0.5, 1.0, (3, 3))
    root = rng.normal(size=(15, 15))
    P = root @ root.T

    def predict(state):
        moved = state.copy()
        kernels.push(moved, np.zeros((15, 15)), d, first, last, noise)
        return moved

    middle, eps = predict(s), 1e-6
    F = np.stack(
        [
            (difference(predict(change(s, eps * e)), middle)
             - difference(predict(change(s, -eps * e)), middle)) / (2.0 * eps)
            for e in np.eye(15)
        ],
        axis=1,
    )  # fmt: skip
    Q = np.zeros((15, 15))
    for i in range(3):
        for k, q in ((i, noise[0, i]), (6 + i, noise[1, i])):
            Q[k, k], Q[k + 3, k + 3] = q * d**3 / 3.0, q * d
            Q[k, k + 3] = Q[k + 3, k] = q * d**2 / 2.0
        Q[12 + i, 12 + i] = noise[2, i] * d
    found = P.copy()
    kernels.push(s.copy(), found, d, first, last, noise)
    # Errors of rates move positions in the second order of d only, which the filter leaves out.
    assert np.allclose(found - P, F @ P @ F.T + Q - P, atol=2e-3 * np.abs(F @ P @ F.T - P).max())
    assert np.allclose(found, found.T, atol=1e-9)


def test_corrections_are_those_of_a_dense_kalman_filter():
    """Two measurements, one after the other, against both at once."""
    rng = np.random.default_rng(3)
    root = rng.normal(size=(15, 15))
    P, H, e, R = root @ root.T, rng.normal(size=(2, 15)), rng.normal(size=2), np.array([0.3, 0.7])
    found, dx = P.copy(), np.zeros(15)
    nis = sum(kernels.learn(found, dx, H[i], e[i], R[i]) for i in range(2))
    S = H @ P @ H.T + np.diag(R)
    gain = P @ H.T @ np.linalg.inv(S)
    assert np.allclose(dx, gain @ e)
    assert np.allclose(found, P - gain @ S @ gain.T)
    assert nis == pytest.approx(e @ np.linalg.solve(S, e))


def test_reports_of_angles_correct_the_attitude_also_over_a_whole_turn():
    s, P = random_state(np.random.default_rng(4)), 1e-6 * np.eye(15)
    wanted = change(s, np.concatenate([np.zeros(6), [1e-3, -2e-3, 1e-3], np.zeros(6)]))
    angles = as_rotation(wanted[6:10]).as_euler("ZYX")[::-1]
    reported = np.concatenate([s[:3], angles + 2.0 * np.pi * np.array([1.0, 0.0, -1.0])])
    kernels.learn_report(s, P, reported, 0.0, np.full(6, 1e-14), np.empty(6))
    assert np.abs(difference(s, wanted)).max() < 1e-5


def test_noiseless_records_come_back():
    truth, setting, measured, settled = make_case("grid.roll=[20]", "grid.snr=[90]")
    estimates = SCHEMES.resolve("ERROR_STATE").prepare(setting).run(measured)
    for found, true in (
        (estimates.position, truth.position), (estimates.velocity, truth.velocity),
    ):  # fmt: skip
        error = np.sqrt(np.mean((found - true)[settled:] ** 2, axis=0))
        # What is left is the interpolation between samples.
        assert np.all(error < 5e-3 * true.std(axis=0))


def test_it_equals_the_linear_filter_at_small_angles_and_beats_it_at_large_ones():
    small, large = ([], []), ([], [])
    for replicate in range(3):
        case = make_case("grid.roll=[0.5]", replicate=replicate)
        for found, name in zip(small, ("ERROR_STATE", "KF_CONSISTENT"), strict=True):
            found.append([judge(name, case)[key] for key in ("position", "velocity")])
        case = make_case("grid.roll=[20]", replicate=replicate)
        large[0].append(judge("ERROR_STATE", case)["position"])
        truth, setting, measured, settled = case
        first_order = replace(
            setting, tuning=setting.tuning.model_copy(update={"attitude": "small"})
        )
        large[1].append(judge("KF_CONSISTENT", (truth, first_order, measured, settled))["position"])
    ratio = np.mean(small[0], axis=0) / np.mean(small[1], axis=0)
    assert ratio == pytest.approx(np.ones(2), abs=0.02)
    assert np.mean(large[0]) < 0.5 * np.mean(large[1])


def test_it_knows_its_errors_and_a_delay():
    found = [
        judge(
            "ERROR_STATE", make_case("grid.roll=[20]", "grid.delay=[3.5]", replicate=k, steps=4000)
        )
        for k in range(3)
    ]
    for dof in ("x", "y", "phi"):
        assert np.mean([each[f"nees_{dof}"] for each in found]) == pytest.approx(1.0, abs=0.2)
    level = [judge("ERROR_STATE", make_case("grid.roll=[20]", replicate=k, steps=4000))
             for k in range(3)]  # fmt: skip
    cost = np.mean([e["position"] for e in found]) / np.mean([e["position"] for e in level])
    assert 1.0 < cost < 1.3


def test_a_record_without_a_report_is_an_estimate_of_nothing():
    _, setting, measured, _ = make_case()
    measured = replace(measured, position=np.full_like(measured.position, np.nan))
    estimates = SCHEMES.resolve("ERROR_STATE").prepare(setting).run(measured)
    assert not estimates.position.any()
    assert np.isnan(estimates.nis).all()


def test_sensors_of_the_basins_frame_are_refused_with_what_works():
    _, setting, _ = make(steps=50)
    with pytest.raises(Unable, match=r"use sensors\.frame=body"):
        SCHEMES.resolve("ERROR_STATE").prepare(replace(setting, tuning=tune()))
