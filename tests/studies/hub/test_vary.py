"""`vary`: errors over the values of one key, as table, figure and sentences; and its refusals."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from tools import SMALL

from owtsweep.cli import BAD_INPUT, DONE, main
from owtsweep.cli.vary import compose_each
from owtsweep.config import conf_directory, with_values
from owtsweep.results.conditions import Condition
from owtsweep.statistics.inference import t_quantile
from owtsweep.studies.base.varying.sentences import answer_each
from owtsweep.studies.hub.bounds.kalman import kalman_bounds
from owtsweep.studies.hub.describe import tell_window
from owtsweep.studies.hub.tuning.search import errors_on_records
from owtsweep.studies.hub.varying import compute, list_common_facts, make_errors

RATE = Condition("value", "sensors.gnss.rate", "Hz", "log")
#: Two schemes and a baseline on short records, at one motion.
QUICK = (
    *SMALL, "tuning=matched", "schemes=[MKF,HME1]", "baselines=[NONE]", "grid.amplitude=[0.7]",
)  # fmt: skip

pytestmark = pytest.mark.usefixtures("kernels")


def test_the_errors_are_what_records_show() -> None:
    _, configs = compose_each([*QUICK, "sensors.gnss.delay=0,0.4"])
    varied = compute(Condition("value", "sensors.gnss.delay", "s"), configs)  # type: ignore[arg-type]
    count = 60
    for v, config in enumerate(configs.values()):
        one = with_values(config, {"tune.amplitude": [0.7, 0.7]})
        errors = errors_on_records(one, ["MKF", "HME1"], count)[:, 0, 0]  # type: ignore[arg-type]
        reach = t_quantile(count - 1) * errors.std(axis=-1, ddof=1) / np.sqrt(count)
        assert np.all(np.abs(errors.mean(axis=-1) - varied.error[:2, v, 0] ** 2) < reach)


def test_table_figure_and_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = [w for w in QUICK if not w.startswith("sensors.gnss.rate")]
    words += [f"results={tmp_path}", "sensors.gnss.rate=4,1"]
    assert main(["vary", *words]) == DONE
    out = " ".join(capsys.readouterr().out.split())
    (folder,) = tmp_path.iterdir()
    names = {path.name for path in folder.iterdir()}
    assert names == {"vary.csv", "vary.png", "vary.svg", "configurations.yaml"}
    assert tell_window("settled") in out
    assert "Not asked: SKFA, which tracks the sea." in out
    table = pd.read_csv(folder / "vary.csv")
    assert list(table["value"].unique()) == [1.0, 4.0]
    assert list(table["scheme"].unique()) == ["MKF", "HME1", "NONE"]
    assert len(table) == 2 * 3
    _, configs = compose_each(words)
    bounds = [kalman_bounds(config)["position"] for config in configs.values()]  # type: ignore[arg-type]
    assert list(table["bound_position"].unique()) == bounds
    schemes = table[table["scheme"] != "NONE"]
    least = np.sqrt(schemes.groupby("value")["mse_position"].min())
    assert f"from {least[1.0]:.3g} m (" in out
    assert f"to {least[4.0]:.3g} m (" in out
    assert f"from {bounds[0] ** 0.5:.3g} to {bounds[1] ** 0.5:.3g} m" in out


def test_a_tuning_file_is_a_category(tmp_path: Path) -> None:
    mine = tmp_path / "mine.yaml"
    printed = yaml.safe_load((conf_directory() / "tuning" / "printed.yaml").read_text())
    mine.write_text(json.dumps(printed))
    words = [word for word in QUICK if not word.startswith("tuning")]
    key, configs = compose_each([*words, f"tuning={mine},paper"])
    assert (key, list(configs)) == ("tuning", [str(mine), "paper"])
    assert [config.tuning for config in configs.values()] == ["printed", "paper"]  # type: ignore[attr-defined]


@pytest.mark.parametrize("flag", ["--cfg", "--dry-run"])
def test_flags_that_compute_nothing(
    flag: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(["vary", "sensors.gnss.rate=1,5", flag]) == DONE
    out = capsys.readouterr().out
    if flag == "--cfg":
        assert "tuning: matched" in out
        assert out.count("\nengine: expected") == 2
        assert out.count("  natural_period:  # s\n  - 4.0\n") == 2
    else:
        assert "folder  results/vary-" in out
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["sensors.gnss.rate=5"], "e.g. KEY=1,2,5, or ask `advise` about one"),
        (["seed=1,2", "sensors.gnss.rate=1,5"], "seed and sensors.gnss.rate: `vary` takes several"),
        (["sensors.gnss.rate=1,1.0"], "sensors.gnss.rate: 1.0 stands there twice"),
        (["sensors.gnss.rate=glob(*)"], "sensors.gnss.rate: list its values, e.g. "),
        (["seed=range(1,1000)"], "seed: 999 values are too many; give at most 100"),
        (["grid.replicates=1,2"], "grid.replicates: `vary` compares sensors, tunings and truths"),
        (["grid.amplitude=1,2"], "grid.amplitude: its values differ in grid, measures, schemes or"),
        (["grid=small", "seed=1,2"], "grid: 20 motions are too many for a figure; give at most 6"),
        (["seed=1,2", "engine=batch"], "engine: `vary` computes means over all records, and "),
        (
            ["seed=1,2", "schemes=[MKF,SKF]", "measures.window=settled"],
            "schemes: `vary` computes all amplitudes at once, and SKF has other gains at each",
        ),
        (["seed=1,2", "name=x"], "name: `vary` names its folder by the query"),
        (["sensors.imu.sigma=1e-20,1e20", "tuning=printed", "schemes=[MKF]", "record.duration=50"],
         "sensors: the Kalman bound cannot be computed for noise of 0.03 m (GNSS) and 1e+20"),
        (["hme.mhe.constraints.bias=null,1"], "schemes: HME2 has no kernel or is not linear"),
        (["seed=1,2", "hydra.verbose=true"], "Hydra's own settings work with `sweep --multirun`"),
    ],
)  # fmt: skip
def test_bad_input_is_one_line_and_writes_nothing(
    words: list[str], says: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["vary", *words, f"results={tmp_path / 'r'}"]) == BAD_INPUT
    err = capsys.readouterr().err
    assert says in err
    assert err.count("\n") == 1
    assert not (tmp_path / "r").exists()


def test_a_fact_that_differs_is_left_out() -> None:
    _, configs = compose_each([*QUICK, "sensors.accuracy=sigma,bound"])
    facts = list_common_facts(list(configs.values()))  # type: ignore[arg-type]
    assert {"tuning matched", "GNSS rate 2 Hz", "IMU bias 0.05 m/s²"} < set(facts)
    assert not any("noise" in fact for fact in facts)


def test_best_is_a_baseline_where_it_has_less_error() -> None:
    rms = np.array([[0.2, 0.1, 0.3], [0.4, 0.2, 0.25], [0.15, 0.15, 0.5]])
    _, configs = compose_each([*QUICK, "sensors.gnss.rate=1,2,5"])
    errors = make_errors(
        RATE, configs, [(4.0, 0.7)], {"position": rms[:, :, None] ** 2},  # type: ignore[arg-type]
        {"position": np.array([0.3, 0.2, 0.1]) ** 2},
    )  # fmt: skip
    assert [errors.name_best(v, 0) for v in range(3)] == ["NONE", "MKF", "HME1"]
    assert [errors.name_best_scheme(v, 0) for v in range(3)] == ["MKF", "MKF", "HME1"]
    assert errors.footnotes == (
        "Thin: baselines (NONE, no estimator: zero position, zero velocity).",
    )
    assert list(answer_each(errors)) == [
        "From 1 Hz to 5 Hz the best scheme's error rises from 0.2 m (MKF) to 0.25 m (HME1), and "
        "the Kalman bound falls from 0.3 to 0.1 m. The error is smallest at 2 Hz: 0.1 m (MKF)."
    ]
