"""`tune`: what it searches, what it writes, how it judges; and the rules of tuning=matched."""

from __future__ import annotations

import logging
from pathlib import Path

import numpy as np
import pytest
from tools import SMALL

from owtsweep import InputError
from owtsweep.cli import BAD_INPUT, DONE, main
from owtsweep.cli.program import INTERRUPTED
from owtsweep.config import with_values
from owtsweep.studies import compose
from owtsweep.studies.base.searching import attempt
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.bounds.kalman import bound_of_axis, kalman_bound
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.noise_floor import noise_floor
from owtsweep.studies.hub.study import HubStudy
from owtsweep.studies.hub.tuning import search
from owtsweep.studies.hub.tuning.search import (
    errors_on_records,
    expected_errors,
    find_space,
    score,
)
from owtsweep.studies.hub.tuning.tuned import judge, list_tunable, tune
from owtsweep.sweep.keys import question_hash, run_hash

#: Searches of a second: MKF, whose error has one free number, on short records.
QUICK = (
    *SMALL, "tuning=matched", "schemes=[MKF]", "tune.trials=6", "tune.replicates=2",
    "tune.amplitude=[0.5,2]",
)  # fmt: skip

pytestmark = pytest.mark.usefixtures("kernels")


def test_the_bound_is_the_published_one() -> None:
    config = compose(["tuning=matched", "sensors=strong_bias"])
    position, _ = bound_of_axis(sensing.sensors(config.sensors))
    assert position == pytest.approx(1.295e-3, rel=1e-3)  # calculated apart from this program
    assert kalman_bound(config) == 2.0 * position


def test_a_filter_that_assumes_nearly_nothing_meets_the_bound() -> None:
    words = ["hme.smoother_window=0", "sensors.imu.bias_walk=0.003", "sensors.imu.rate=100"]
    config = compose([*SMALL, "tuning=matched", *words])
    known = sensing.sensors(config.sensors)
    position, velocity = bound_of_axis(known)
    free = with_values(config, {"hme1.q_a": 1.0})
    floor = noise_floor(resolve("HME1").kernel(Known(known, free)), known)
    assert 1.0 <= floor.of("position") / (2.0 * position) < 1.01
    assert 1.0 <= floor.of("velocity") / (2.0 * velocity) < 1.01


def test_the_objective_is_what_records_show() -> None:
    config = compose([*QUICK, "record.duration=150", "measures.settling_time=50"])
    expected = expected_errors(config, resolve("MKF"))
    (errors,) = errors_on_records(config, ["MKF"], 4)
    assert errors.shape == (*expected.shape, 4)
    assert errors.mean(axis=-1) == pytest.approx(expected, rel=0.1)


def test_a_search_is_repeatable_and_its_file_is_taken(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(search, "_list_starts", lambda *_: [])  # else the best is the rules' number
    path = tmp_path / "new" / "mine.yaml"
    words = ["tune", *QUICK, "mkf.q_a=200", "--output", str(path)]
    assert main(words) == DONE
    text = path.read_text()
    printed = capsys.readouterr().out
    assert "change" in printed
    assert f"tuning={path}" in printed
    taken = compose([*QUICK[:-5], f"tuning={path}"])
    assert taken.tuning == "mine"
    assert taken.mkf.q_a != 200.0
    before = compose([*QUICK, "mkf.q_a=200"])
    assert tune(before, lambda _: None).text("mine") == text
    assert judge(before, taken, ["MKF"])["MKF"].change < 0.0


def test_an_interrupt_keeps_the_best_so_far(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    judged = [1.0, 1.0, 0.5]

    def interrupted(*_: object) -> float:
        if not judged:
            raise KeyboardInterrupt
        return judged.pop(0)

    monkeypatch.setattr(search, "_judge", interrupted)
    path = tmp_path / "mine.yaml"
    assert main(["tune", *QUICK, "--output", str(path)]) == INTERRUPTED
    assert "the best of the 2 trials" in capsys.readouterr().err
    assert "stopped after 2 trials" in path.read_text()
    assert compose([f"tuning={path}"]).mkf.q_a != 0.455


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["tuning=[paper,matched]"], "begins with one tuning"),
        (
            ["study=mating"],
            "study: `tune` serves hub, tower, floater, blade only, not 'mating'",
        ),
        (["--output", "mine.txt"], "ends in .yaml"),
        (["--output", f"{'a' * 300}.yaml"], "the name has more than 255 bytes"),
        (["tune.seed=2019"], "tune.seed"),
        (["tune.amplitude=[2,1]"], "reversed"),
        (["schemes=[{_target_:hold_last_fix.HoldLastFix}]"], "knows the numbers of"),
    ],
)
def test_bad_input_is_one_line(
    words: list[str], told: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path,
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert main(["tune", *words]) == BAD_INPUT
    assert told in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_every_searched_number_is_a_number_of_the_configuration() -> None:
    config = compose(["tuning=matched", "sensors.gnss.rate=5"])
    for scheme in list_tunable(config):
        space = find_space(config, scheme.name)
        ends = {key: b["options"][-1] if "options" in b else b[1] for key, b in space.items()}
        HubStudy().check(with_values(config, ends))


def test_the_rules_know_the_sensors_and_give_way_to_overrides() -> None:
    known = compose(["tuning=matched"])
    assert (known.mkf.q_a, known.hme1.q_a, known.hme2.q_a) == (0.455, 1.07, 13.9)
    assert known.hme2.r_gnss.scale == 0.0611
    assert known.hme == compose(["tuning=matched", "sensors=strong_bias"]).hme
    fast = compose(["sensors.gnss.rate=5", "sensors.imu.sigma=0.05"])
    assert fast.hme.mhe.interval == 0.2
    assert fast.mkf.q_a < known.mkf.q_a
    assert compose(["tuning=matched", "mkf.q_a=3", "sensors.imu.sigma=0.05"]).mkf.q_a == 3.0


def test_what_tune_searches_makes_no_other_run_and_no_other_question() -> None:
    plain, other = compose(["tuning=matched"]), compose(["tuning=matched", "tune.trials=5"])
    assert run_hash(other) == run_hash(plain)
    assert question_hash(other) == question_hash(plain)


def test_beyond_their_range_the_rules_name_tune(caplog: pytest.LogCaptureFixture) -> None:
    with caplog.at_level(logging.WARNING, logger="owtsweep"):
        compose(["tuning=matched", "sensors.gnss.sigma=0.3"])
        assert caplog.messages == []
        compose(["tuning=matched", "sensors.gnss.sigma=3"])
    (message,) = caplog.messages
    assert message.startswith("sensors.gnss.sigma: 3 lies beyond")
    assert "tune" in message
    caplog.clear()
    compose(["tuning=paper", "sensors.gnss.sigma=3"])
    assert caplog.messages == []


def test_a_wrong_sensor_is_named_before_any_rule() -> None:
    with pytest.raises(InputError, match=r"sensors\.gnss\.sigma"):
        compose(["tuning=matched", "sensors.gnss.sigma=-1"])
    with pytest.raises(InputError, match=r"sensors\.gnss\.rate"):
        compose(["tuning=matched", "sensors.gnss.rate=0"])


def test_the_score_weighs_ratios() -> None:
    assert score(np.array([[1.0, 100.0]])) == pytest.approx(10.0)
    judged = attempt(lambda _: score(np.array([[1.0, np.nan]])), {})
    assert judged.score == float("inf")
