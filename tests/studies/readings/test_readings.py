"""The search: what is searched, that its trail is kept, and that its judges judge."""

from __future__ import annotations

import sys

import numpy as np
import pytest
import yaml

from owtsweep.config import conf_directory, with_values
from owtsweep.errors import InputError
from owtsweep.studies import compose, get_study
from owtsweep.studies.readings import engine, searches
from owtsweep.studies.readings import score as scoring
from owtsweep.sweep.run import sweep

pytestmark = pytest.mark.usefixtures("kernels")

SHORT = ["experiment=readings", "calibration.replicates=1", "record.duration=60"]
ONE = {
    "kind": "settled",
    "schemes": ["HME1"],
    "tuning": "matched",
    "truth": {"record.duration": 60.0},
    "parameters": {"hme1.q_a": [0.01, 1000.0, "log"], "hme.smoother_window": [1, 40, "int"]},
    "start": {"hme1.q_a": 900.0, "hme.smoother_window": 2},
}


def small(trials: int, target: dict[str, object]) -> searches.ReadingsConfig:
    config = compose([*SHORT, f"calibration.trials={trials}", "grid=tables"])
    return with_values(config, {"calibration.targets": {"one": target}})


def test_a_search_keeps_its_whole_trail_and_gets_better():
    config = small(12, ONE)
    (block,) = searches.plan(config)
    assert block.cases == 12
    ((_, rows),) = searches.run(config, [block])
    assert list(rows.trial) == list(range(12))
    assert rows.loc[0, "hme1.q_a"] == 900.0
    assert (rows.n_parameters == 2).all()
    assert rows.score.min() < 0.97 * rows.score[0]
    ((_, again),) = searches.run(config, [block])
    assert again.equals(rows)
    best = engine.rank_trials(rows)
    assert best.score.is_monotonic_increasing
    assert best.score[0] == rows.score.min()


def test_the_settled_judge_is_the_geometric_mean_over_the_grid():
    config = small(1, ONE)
    base = with_values(config, searches.read_tuning("matched"))
    lanes = scoring.make_lanes(base, range(1), [4.0, 8.0])
    judged = scoring.score_settled(base, ["HME1"], lanes)[0]
    settled = with_values(base, {"measures.window": "settled"})
    products = scoring.scheme_products(settled, "HME1", lanes)
    values = [
        N**2 * p[:2, 0].sum() + 2 * N * p[:2, 1].sum() + p[:2, 2].sum()
        for p in products.values()
        for N in config.grid.amplitude
    ]
    assert judged == pytest.approx(np.prod(values) ** (1 / len(values)), rel=1e-12)


def test_a_published_target_is_judged_on_the_printed_numbers():
    config = compose([*SHORT, "calibration.trials=1"])
    blocks = [b for b in searches.plan(config) if b.content["target_name"] in ("paper", "ekf")]
    ((_, paper),) = searches.run(config, blocks[:1])
    row = paper.iloc[0]
    assert 0.0 < row.median_log2 < row.p80_log2
    assert set(row.winners.split()) <= {"MKF", "HME1", "HME2"}
    assert len(row.winners.split()) == 4
    assert row.n_parameters == 9
    assert {block.content["truth_name"] for block in blocks} == set(config.calibration.truths)


def test_a_diverging_trial_is_kept_and_counts_as_bad(monkeypatch):
    def diverge(*_):
        raise InputError("update_rule: makes the covariance negative")

    config = small(1, ONE)
    monkeypatch.setattr(scoring, "scheme_products", diverge)
    ((_, rows),) = searches.run(config, searches.plan(config))
    assert rows.score[0] == searches.DIVERGED
    assert rows.status[0] == "failed"
    assert "update_rule" in rows.reason[0]


def test_what_was_found_can_be_written_into_the_tuning_without_undoing_the_search():
    fixed = searches.take_fixed_values(ONE, "paper")
    assert "hme1.q_a" not in fixed
    assert "hme.smoother_window" not in fixed
    assert fixed["hme1.model"] == "sigma1"
    assert not any(key.startswith(("mkf", "sensors", "record", "tuning")) for key in fixed)


def test_scores_boundary_solves_the_quadratic():
    rng = np.random.default_rng(3)
    for _ in range(20):
        upper = np.array([[0.1, 0.02, 3.0]] * 4) + 0.01 * rng.standard_normal((4, 3))
        lower = np.array([[0.9, 0.05, 1.0]] * 4) + 0.01 * rng.standard_normal((4, 3))
        at = scoring.boundary(lower, upper)
        difference = scoring.at_amplitude(lower[:2] - upper[:2], at).sum()
        assert difference == pytest.approx(0.0, abs=1e-12)
        assert scoring.at_amplitude(lower[:2] - upper[:2], 0.9 * at).sum() < 0.0
    assert np.isnan(scoring.boundary(upper, lower))


def test_it_runs_like_every_study_and_draws_its_trail(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    config = with_values(small(2, ONE), {"compute.backend": "threading"})
    run = sweep(get_study("readings"), config).run
    assert list(run.table("trials").trial) == [0, 1]
    files = run.draw()
    assert {file.name for file in files} == {
        "score_over_parameters_one.png",
        "score_over_parameters_one.svg",
    }
    assert all(file.is_file() for file in files)


@pytest.mark.parametrize(
    ("change", "says"),
    [
        ({"kind": "guess"}, "published, settled"),
        ({"tuning": "mached"}, "matched"),
        ({"kind": "published", "truths": ["1000"]}, "1000s_walk1e-4"),
    ],
)
def test_bad_targets_are_refused_before_anything_runs(change, says):
    with pytest.raises(InputError, match=says):
        searches.plan(small(1, {**ONE, **change}))


def test_a_search_needs_a_motion_with_a_spectrum():
    with pytest.raises(InputError, match=r"numbers of a spectrum; leave out motion=plant"):
        compose([*SHORT, "motion=plant", "structure=ren2019"])


def test_an_unknown_parameter_of_a_truth_is_refused():
    config = compose([*SHORT, "calibration.trials=1"])
    config = with_values(config, {"calibration.truths": {"odd": {"sensors.imu.bais": 1.0}}})
    with pytest.raises(InputError, match=r"bais"):
        searches.plan(config)


def test_without_cmaes_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setitem(sys.modules, "cmaes", None)
    with pytest.raises(InputError, match=r"owtsweep\[calibrate\]"):
        searches.plan(compose(SHORT))


def test_tunings_are_complete_and_state_their_name():
    keys = None
    for path in (conf_directory() / "tuning").glob("*.yaml"):
        values = searches.read_tuning(path.stem)
        assert values["tuning"] == path.stem
        assert yaml.safe_load(path.read_text()) is not None
        # the frozen copies are older than the key `tilt`
        scheme_keys = {
            key
            for key in values
            if not key.startswith(("sensors.", "record.")) and not key.endswith(".tilt")
        }
        keys = keys or scheme_keys
        assert scheme_keys == keys
