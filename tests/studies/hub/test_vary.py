"""`vary`: errors over the values of one key, as table, figure and sentences; and its refusals."""

from __future__ import annotations

import io
import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml
from matplotlib.text import Text
from rich.console import Console
from tools import SMALL

from owtsweep.cli import BAD_INPUT, DONE, main
from owtsweep.cli.vary import compose_each
from owtsweep.config import conf_directory, with_values
from owtsweep.results.conditions import Condition
from owtsweep.statistics.inference import t_quantile
from owtsweep.studies.hub.bounds.kalman import kalman_bounds
from owtsweep.studies.hub.describe import OTHER_WINDOW
from owtsweep.studies.hub.tuning.errors import errors_on_records
from owtsweep.studies.hub.varying.drawing import draw
from owtsweep.studies.hub.varying.errors import Errors, compute, list_common_facts
from owtsweep.studies.hub.varying.sentences import answer_each, find_best
from owtsweep.studies.hub.varying.varied import VariedErrors

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
        assert np.all(np.abs(errors.mean(axis=-1) - varied.mse["position"][:2, v, 0]) < reach)


def test_table_figure_and_answer(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = [w for w in QUICK if not w.startswith("sensors.gnss.rate")]
    words += [f"results={tmp_path}", "sensors.gnss.rate=4,1"]
    assert main(["vary", *words]) == DONE
    out = " ".join(capsys.readouterr().out.split())
    (folder,) = tmp_path.iterdir()
    names = {path.name for path in folder.iterdir()}
    assert names == {"vary.csv", "vary.png", "vary.svg", "configurations.yaml"}
    assert OTHER_WINDOW["settled"] in out
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
    flag: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["vary", "sensors.gnss.rate=1,5", f"results={tmp_path / 'r'}", flag]) == DONE
    out = capsys.readouterr().out
    if flag == "--cfg":
        assert "tuning: matched" in out
        assert out.count("\nengine: expected") == 2
        assert out.count("  natural_period:  # s\n  - 4.0\n") == 2
    else:
        assert f"folder  {tmp_path / 'r'}/vary-" in out
    assert not (tmp_path / "r").exists()


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["sensors.gnss.rate=5"], "overrides: none has several values; give one key its values"),
        (["seed=1,2", "sensors.gnss.rate=1,5"], "seed and sensors.gnss.rate: `vary` takes several"),
        (["sensors.gnss.rate=1,1.0"], "sensors.gnss.rate: 1.0 stands there twice"),
        (["sensors.gnss.rate=glob(*)"], "sensors.gnss.rate: list its values, e.g. "),
        (["seed=range(1,1000)"], "seed: 999 values are too many; give at most 100"),
        (["grid.amplitude=[1],[2]"], "grid.amplitude: `vary` compares sensors, tunings and truths"),
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
        (["seed=1,2", "study=readings"], "study: `vary` serves hub only, not 'readings'"),
        (["seed=1,2", "study=tower"], "`vary` serves hub only, not 'tower'"),
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


def test_a_terminal_of_80_columns_cuts_no_number() -> None:
    schemes, baselines = ("EKF", "MKF", "HME1", "HME2"), ("NONE", "HOLD", "DELTA")
    mse = np.random.default_rng(0).uniform(0.001, 0.01, (7, 3, 1))
    errors = Errors(
        along=Condition("value", "sensors.gnss.rate", "Hz"), values=(1.0, 2.5, 10.0),
        schemes=schemes, baselines=baselines, motions=((4.0, 0.5),), criterion="position",
        mse={"position": mse}, bounds={"position": np.full(3, 0.00123)}, facts=("tuning x",),
        notes=(),
    )  # fmt: skip
    texts = " ".join(" ".join(text.get_text() for text in draw(errors).findobj(Text)).split())
    assert "Thin: baselines (NONE, no estimator: zero position, zero velocity; HOLD" in texts
    console = Console(width=80, record=True, file=io.StringIO())
    console.print(VariedErrors(errors).answer())
    told = console.export_text()
    assert "…" not in told
    for number in np.sqrt(mse).flat:
        assert f" {number:.3g} " in told


def test_best_is_a_baseline_where_it_has_less_error() -> None:
    rms = np.array([[0.2, 0.1, 0.3], [0.4, 0.2, 0.25], [0.15, 0.15, 0.5]])
    errors = Errors(
        along=RATE, values=(1.0, 2.0, 5.0), schemes=("A", "B"), baselines=("NONE",),
        motions=((4.0, 0.5),), criterion="position", mse={"position": rms[:, :, None] ** 2},
        bounds={"position": np.ones(3)}, facts=(), notes=(),
    )  # fmt: skip
    assert find_best(errors, errors.names) == [[("NONE",), ("A",), ("B",)]]
    assert find_best(errors, errors.schemes) == [[("A",), ("A",), ("B",)]]
    console = Console(width=100, record=True, file=io.StringIO())
    console.print(VariedErrors(errors).answer())
    rows = [line.split() for line in console.export_text().splitlines()]
    assert [row[-1] for row in rows if row[:1] in (["1"], ["2"], ["5"])] == ["NONE", "A", "B"]


def test_the_sentences_say_what_the_numbers_are() -> None:
    rms = np.array([[0.2, 0.1, 0.3], [0.4, 0.2, 0.25], [0.15, 0.15, 0.5]])
    errors = Errors(
        along=RATE, values=(1.0, 2.0, 5.0), schemes=("A", "B"), baselines=("NONE",),
        motions=((4.0, 0.5),), criterion="position", mse={"position": rms[:, :, None] ** 2},
        bounds={"position": np.array([0.3, 0.2, 0.1]) ** 2}, facts=(), notes=(),
    )  # fmt: skip
    assert list(answer_each(errors)) == [
        "From 1 Hz to 5 Hz the best scheme's error rises from 0.2 m (A) to 0.25 m (B), and the "
        "Kalman bound falls from 0.3 to 0.1 m. The error is smallest at 2 Hz: 0.1 m (A). NONE has "
        "less error than every scheme at 1 Hz."
    ]
    names = replace(errors, along=Condition("value", "tuning"), values=("x", "y", "z"))
    assert next(answer_each(names)).startswith(
        "The best scheme's error is smallest with y (A, 0.1 m; bound 0.2 m) and largest with z (B"
    )
