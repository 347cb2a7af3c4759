"""The error-state filter of reports: without noise, at any angle, over long records."""

from dataclasses import replace

import numpy as np
import pytest
from linear_records import make, tune
from scipy.spatial.transform import Rotation

from owtsweep.estimation.inertial.reports import learn_report
from owtsweep.estimation.inertial.strapdown import ERRORS, STATES, correct, subtract
from owtsweep.studies import compose
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.floater.contest import CONTEST
from owtsweep.studies.floater.declaration import make_setting
from owtsweep.studies.floater.measures import compare
from owtsweep.studies.floater.measuring import measure
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.truth import make_truth

STEP = 0.05


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
        measure(config, motion, cell), config.record.settled,
    )  # fmt: skip


def judge(scheme, case):
    truth, setting, measured, settled = case
    estimates = SCHEMES.resolve(scheme).prepare(setting).run(measured)
    return compare(truth, estimates, setting.position_sigma, settled)


def test_reports_of_angles_correct_the_attitude_also_over_a_whole_turn():
    s, P = np.random.default_rng(4).normal(size=STATES), 1e-6 * np.eye(ERRORS)
    s[6:10] /= np.linalg.norm(s[6:10])
    wanted, left = s.copy(), np.empty(ERRORS)
    correct(wanted, np.concatenate([np.zeros(6), [1e-3, -2e-3, 1e-3], np.zeros(6)]))
    angles = Rotation.from_quat(wanted[6:10], scalar_first=True).as_euler("ZYX")[::-1]
    reported = np.concatenate([s[:3], angles + 2.0 * np.pi * np.array([1.0, 0.0, -1.0])])
    learn_report(s, P, reported, 0.0, np.full(6, 1e-14), np.empty(6))
    subtract(s, wanted, left)
    assert np.abs(left).max() < 1e-5


def test_rounding_does_not_grow_with_the_record():
    """A change of the last digit is one at the end of ten minutes, too."""
    _, setting, measured, _ = make_case("grid.roll=[20]", "grid.delay=[3.5]", steps=12000)
    other = replace(measured, specific_force=measured.specific_force * (1.0 + 4e-16))
    scheme = SCHEMES.resolve("ERROR_STATE").prepare(setting)
    found, moved = scheme.run(measured).position, scheme.run(other).position
    assert np.abs(found - moved).max() < 1e-12


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
