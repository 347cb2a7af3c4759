"""SKF, which is told the motion: its forms agree, and its covariance is honest."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text
from scipy.stats import t as student
from tools import Streaming, assert_same, configure, measured, rows_of

from owtsweep.api import online
from owtsweep.errors import InputError
from owtsweep.studies import compose
from owtsweep.studies.hub import spectral_model
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.engines import superposes
from owtsweep.studies.hub.expected.spectral import find_expected_errors
from owtsweep.studies.hub.figures.time_histories import draw as draw_histories
from owtsweep.studies.hub.histories import simulate_histories
from owtsweep.studies.hub.schemes.skf import find_motion
from owtsweep.studies.hub.spectral_model import make_axis
from owtsweep.studies.hub.study import HubStudy
from owtsweep.testing.hub_schemes import check_hub_scheme

SKF: Any = resolve("SKF")
TOLD = ("skf.natural_period=4", "skf.amplitude=0.7", "skf.states=6", "schemes=[SKF]")


def told(*overrides: str) -> HubConfig:
    return configure(*TOLD, *overrides)


@pytest.mark.usefixtures("kernels")
def test_skf_keeps_the_contract_step_by_step_and_online() -> None:
    config = told()
    check_hub_scheme(SKF, config)
    check_hub_scheme(Streaming(SKF), config)


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("delay", [0.0, 0.2, 0.5, 1.3])
def test_online_form_gives_what_the_reference_gives(delay: float) -> None:
    config = told(f"sensors.gnss.delay={delay}", "sensors.imu.tilt=0.02", "record.duration=25")
    data, sensors = measured(config)
    M = sensors.fix_interval
    reference, stream = SKF.start(Known(sensors, config)), SKF.stream(Known(sensors, config))
    fixes = np.full((len(data.specific_force), 2), np.nan)
    fixes[::M] = data.fixes
    fixes[[7 * M, 8 * M, 30 * M]] = np.nan  # lost
    whole, lost = [], []
    again = SKF.start(Known(sensors, config))
    for k, force in enumerate(data.specific_force):
        estimate = reference.update(force, data.fixes[k // M] if k % M == 0 else None)
        whole.append([*estimate.position, *estimate.velocity])
        lost.append(again.update(force, None if np.isnan(fixes[k, 0]) else fixes[k]))
    fixes_kept = np.full_like(fixes, np.nan)
    fixes_kept[::M] = data.fixes
    out = SKF.stream(Known(sensors, config)).run_record(data.specific_force, fixes_kept)
    assert_same(out.state, np.array(whole), "online, all fixes")
    out = stream.run_record(data.specific_force, fixes)
    states = np.array([[*estimate.position, *estimate.velocity] for estimate in lost])
    assert_same(out.state, states, "online, fixes lost")
    covariance = np.array([estimate.covariance for estimate in lost])
    np.testing.assert_allclose(out.covariance, covariance, rtol=1e-8, atol=1e-14)
    given = [k for k, estimate in enumerate(lost) if estimate.innovation is not None]
    innovation = np.array([lost[k].innovation.value for k in given])
    assert_same(out.innovation[given], innovation, "innovation")


@pytest.mark.usefixtures("kernels")
def test_covariance_is_honest_and_the_errors_are_those_expected() -> None:
    config = configure(
        "schemes=[SKF]", "skf.states=10", "grid.replicates=16", "record.duration=500",
        "measures.settling_time=120", "grid.amplitude=[0.2,3.0]", "normalise=rms",
    )  # fmt: skip
    rows = rows_of(config)
    for amplitude in (0.2, 3.0):

        def mean(measure: str, amplitude: float = amplitude) -> float:
            values = [
                row["value"] for key, row in rows.items()
                if key.measure == measure and key.window == "settled" and key.amplitude == amplitude
            ]  # fmt: skip
            assert len(values) == 16
            return float(np.mean(values))

        assert 0.95 < mean("nees") / 4.0 < 1.05
        assert 0.9 < mean("nis") / 2.0 < 1.1
        expected = find_expected_errors(config, 4.0, amplitude).true.sum(axis=0)
        assert mean("position") == pytest.approx(expected[0], rel=0.06)
        assert mean("velocity") == pytest.approx(expected[1], rel=0.06)


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("scale", [1.0, 1.02])
def test_expected_engine_gives_the_mean_of_the_records_settled_errors(scale: float) -> None:
    settings = (
        "schemes=[MKF,SKF]", "skf.states=6", "normalise=rms", "record.duration=400",
        "measures.settling_time=150", "measures.window=settled", "grid.replicates=12",
        "grid.amplitude=[0.2,10]", f"sensors.gnss.scale={scale}",
    )  # fmt: skip
    config = configure(*settings, "engine=expected")
    study = HubStudy().engine(config)
    rows = pd.concat([rows for _, rows in study.run(config, study.plan(config))])
    tables = study.tables(config, rows)
    summary = tables["summary"].set_index(["scheme", "amplitude", "measure", "window"])["mean"]
    records = rows_of(configure(*settings))
    for amplitude in (0.2, 10.0):
        true = find_expected_errors(config, 4.0, amplitude).true
        for measure, expected in zip(("position", "velocity"), true.sum(axis=0), strict=True):
            assert summary["SKF", amplitude, measure, "settled"] == pytest.approx(expected)
            values = [
                row["value"] for key, row in records.items()
                if (key.scheme, key.measure, key.window) == ("SKF", measure, "settled")
                and key.amplitude == amplitude
            ]  # fmt: skip
            assert len(values) == 12
            half = student.ppf(0.9995, 11) * np.std(values, ddof=1) / np.sqrt(12.0)
            assert np.mean(values) == pytest.approx(expected, abs=half)
            assert half < 0.3 * expected
        assert summary["SKF", amplitude, "x", "settled"] == pytest.approx(true[0, 0])
        assert summary["SKF", amplitude, "vy", "settled"] == pytest.approx(true[1, 1])
    assert ("SKF", 0.2, "position", "full") not in summary.index
    assert set(tables["best_scheme"]["best"]) == {"SKF"}


@pytest.mark.usefixtures("kernels")
def test_batch_and_reference_engine_give_the_same_rows() -> None:
    rows = rows_of(configure("schemes=[SKF,MKF]", "skf.states=6"))
    reference = rows_of(configure("schemes=[SKF,MKF]", "skf.states=6", "engine=reference"))
    assert {key.amplitude for key in rows if key.scheme == "SKF"} == {0.05, 0.7, 10.0}
    assert rows.keys() == reference.keys()
    for key, row in rows.items():
        if key.scheme == "SKF":
            assert row["value"] == pytest.approx(reference[key]["value"], rel=1e-7)


@pytest.mark.usefixtures("kernels")
def test_gains_are_made_once_for_all_records_of_a_cell(monkeypatch: pytest.MonkeyPatch) -> None:
    made = []

    def make(*arguments: Any) -> Any:
        made.append(arguments)
        return make_axis(*arguments)

    monkeypatch.setattr(spectral_model, "make_axis", make)
    settings = (
        "schemes=[MKF,SKF]", "skf.states=6", "record.duration=31",
        "grid.amplitude=[0.05,0.1,0.7,2,10]",
    )  # fmt: skip
    rows = rows_of(configure(*settings, "grid.replicates=9"))
    assert len(made) == 2 * len({key.amplitude for key in rows if key.scheme == "SKF"}) == 10
    assert {key.replicate for key in rows if key.scheme == "SKF"} == set(range(9))
    for key, row in rows_of(configure(*settings, "grid.replicates=2")).items():
        assert row["value"] == rows[key]["value"] or row["amplitude"] is None


@pytest.mark.usefixtures("kernels")
def test_time_histories_say_that_skf_is_left_out() -> None:
    histories = simulate_histories(configure("schemes=[MKF,SKF,SKFA]"))
    figure = draw_histories(histories, "position", tuning="matched")
    shown = " ".join(" ".join(text.get_text() for text in figure.findobj(Text)).split())
    for name in ("SKF", "SKFA"):
        assert f"{name} is left out: it is none of the filter chains that this figure" in shown


def test_skf_is_told_its_cell_unless_the_configuration_says_otherwise() -> None:
    config, one = configure("schemes=[SKF]"), configure("schemes=[SKF]", "skf.amplitude=3")
    assert not superposes(config, SKF)
    sensors = measured(config)[1]
    told, stated = (find_motion(Known(sensors, each, 4.0, 0.7)) for each in (config, one))
    assert np.sum(told.variance) == pytest.approx((0.7 / 3.0) ** 2 * np.sum(stated.variance))


def test_more_bias_walk_or_a_wrong_tilt_changes_the_estimate() -> None:
    config = told()
    data, sensors = measured(config)
    leaning = replace(sensors, tilt=0.05)

    def last(config: HubConfig, sensors: Any) -> Any:
        return SKF.stream(Known(sensors, config)).run_record(
            data.specific_force, _fixes(data, sensors)
        )

    own = last(config, leaning)
    assert np.allclose(own.state, last(told("skf.tilt=0.05"), sensors).state, rtol=1e-12)
    assert not np.allclose(own.state, last(config, sensors).state)
    walking = last(told("skf.q_b=0.01"), sensors)
    assert walking.covariance[-1, 0, 0] > last(config, sensors).covariance[-1, 0, 0]


def test_what_skf_states_of_its_error_is_so_for_an_imu_that_leans() -> None:
    settings = ("schemes=[SKF]", "skf.states=10", "normalise=rms", "sensors.imu.tilt=0.05")
    knows = find_expected_errors(configure(*settings), 4.0, 1.0)
    np.testing.assert_allclose(knows.true, knows.stated, rtol=0.03)
    wrong = find_expected_errors(configure(*settings, "skf.tilt=0"), 4.0, 1.0)
    assert np.all(wrong.true[:, 0] > 1.05 * knows.true[:, 0])


def test_on_board_estimates_are_in_the_coordinates_of_the_fixes() -> None:
    config, at = told(), np.array([100.0, -50.0])
    data, sensors = measured(config)
    fixes = _fixes(data, sensors)
    there = SKF.stream(Known(sensors, config), origin=at).run_record(
        data.specific_force, fixes + at
    )
    here = SKF.stream(Known(sensors, config)).run_record(data.specific_force, fixes)
    np.testing.assert_allclose(there.state[:, :2], here.state[:, :2] + at, atol=1e-11)
    np.testing.assert_allclose(there.state[:, 2:], here.state[:, 2:], atol=1e-11)


def _fixes(data: Any, sensors: Any) -> Any:
    fixes = np.full((len(data.specific_force), 2), np.nan)
    fixes[:: sensors.fix_interval] = data.fixes
    return fixes


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["skf.states=7"], "skf.states: 7 is odd"),
        (["skf.states=26"], "skf.states"),
        (
            ["engine=expected", "measures.window=full"],
            "measures.window: engine=expected knows the errors of SKF once",
        ),
        (
            ["engine=expected", "measures.window=settled", "sensors.imu.bias_walk=0"],
            "schemes: without a bias walk SKF never settles",
        ),
        (["motion=plant"], "SKF needs the spectrum of the motion"),
    ],
)
def test_what_skf_cannot_do_is_refused_in_one_line(overrides: list[str], message: str) -> None:
    with pytest.raises(InputError) as caught:
        compose(["schemes=[SKF]", "tuning=matched", *overrides])
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_on_board_skf_must_be_told_the_motion_and_the_origin() -> None:
    with pytest.raises(InputError, match=r"skf.natural_period, skf.amplitude: SKF must be told"):
        online("SKF", origin=(0.0, 0.0))
    with pytest.raises(InputError, match="origin: this scheme must know where the hub is at rest"):
        online("SKF", ["skf.natural_period=4", "skf.amplitude=0.7", "skf.states=6"])
    with pytest.raises(InputError, match=r"skf.natural_period, skf.amplitude: SKF must be told"):
        SKF.start(Known(measured(configure())[1], configure()))


@pytest.mark.usefixtures("kernels")
def test_a_bad_sample_on_board_leaves_the_estimator_as_it_was() -> None:
    config = told()
    data, sensors = measured(config)
    estimator, other = SKF.stream(Known(sensors, config)), SKF.stream(Known(sensors, config))
    bad = [
        ((np.array([np.nan, 0.0]), None), "specific_force: it is not finite at step 3"),
        ((np.zeros(2), np.array([np.nan, 0.0])), "a fix has a component that is missing"),
        ((np.zeros(3), None), "specific_force: .* is not two numbers"),
        ((np.zeros(2), np.zeros(2)), "a fix came at step 3, but SKF takes fixes only at multiples"),
    ]
    for k, force in enumerate(data.specific_force[:40]):
        fix = data.fixes[k // sensors.fix_interval] if k % sensors.fix_interval == 0 else None
        if k == 3:
            for sample, message in bad:
                with pytest.raises(ValueError, match=message):
                    estimator.update(*sample)
        np.testing.assert_array_equal(
            estimator.update(force, fix).position, other.update(force, fix).position
        )
