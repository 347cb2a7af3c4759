"""The baselines NONE, HOLD and DELTA: their definitions, in every engine, tables and maps."""

from __future__ import annotations

import io
import math
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from matplotlib.text import Text
from rich.console import Console
from tools import SMALL, configure, measured, ned, plan_blocks, rows_of

import owtsweep
from owtsweep.errors import InputError
from owtsweep.evaluation.loop import run_estimator
from owtsweep.figures import best_scheme_map
from owtsweep.figures.best_scheme_map import RUNNER_UP
from owtsweep.io import cache
from owtsweep.studies.hub import batch, describe, estimates
from owtsweep.studies.hub.bounds.kalman import kalman_bounds
from owtsweep.studies.hub.contract import BASELINES, Known, resolve
from owtsweep.studies.hub.expected import drawing
from owtsweep.studies.hub.expected import engine as expected_engine
from owtsweep.studies.hub.figures import listing, maps_by_tuning, mse_over_amplitude
from owtsweep.studies.hub.study import HubStudy
from owtsweep.sweep.keys import block_key, run_hash
from owtsweep.sweep.plan import make_plan

pytestmark = pytest.mark.usefixtures("kernels")

ALL = "baselines=[NONE,HOLD,DELTA]"
#: Both times end between two fixes, which come every .5 s.
SHORT = ("record.duration=12.35", "measures.settling_time=3.15", "grid.amplitude=[0.2,3.0]")


def defined(name: str, fixes: np.ndarray, steps: int, sensors) -> np.ndarray:
    """The estimates (steps, 4) by the words of docs/hub.md, from the list of fixes."""
    state = np.zeros((steps, 4))
    for k in range(steps):
        last, age = divmod(k, sensors.fix_interval)
        if name in ("HOLD", "DELTA"):
            state[k, :2] = fixes[last]
        if name == "DELTA" and last > 0:
            velocity = (fixes[last] - fixes[last - 1]) / (sensors.fix_interval * sensors.step)
            state[k, :2] += (age + sensors.delay) * sensors.step * velocity
            state[k, 2:] = velocity
    return state


@pytest.mark.parametrize("name", BASELINES)
@pytest.mark.parametrize(
    "changes",
    # 600 steps cross the border between two chunks; delays: default, none, longer than .5 s
    [
        (),
        ("sensors.gnss.delay=0.0",),
        ("sensors.gnss.delay=0.65",),
        ("sensors.gnss.rate=20", "hme.mhe.interval=0.05"),
    ],
    ids=str,
)
def test_both_forms_are_the_definition(name: str, changes: tuple[str, ...]) -> None:
    config = configure(*changes, "record.duration=30")
    scheme = resolve(name)
    data, sensors = measured(config)
    steps = len(data.specific_force)
    assert steps > batch.CHUNK
    exact = defined(name, data.fixes, steps, sensors)
    stepwise = run_estimator(scheme.start(Known(sensors, config)), *data, sensors.fix_interval)
    chain = scheme.kernel(Known(sensors, config), steps)
    compiled = np.hstack(estimates.trajectories(chain, *ned(data, sensors))[:2])
    scale = np.maximum(np.max(np.abs(exact), axis=0), 1e-300)
    assert np.all(np.abs(stepwise.state - exact) <= 1e-12 * scale)
    assert np.all(np.abs(compiled - exact) <= 1e-9 * scale)
    assert stepwise.covariance is None
    assert stepwise.innovation is None
    assert not chain.has_covariance


def test_a_missing_fix_is_bridged() -> None:
    # of fixes a second apart, the third is lost: velocity over two seconds, then none new
    _, sensors = measured(configure("sensors.gnss.rate=1"))
    hold, delta = (resolve(name).start(Known(sensors, None)) for name in ("HOLD", "DELTA"))
    fixes = {1: 1.0, 21: 2.0, 61: 8.0}  # the first one comes late
    answers = [
        [e.update(np.zeros(2), np.full(2, fixes[k]) if k in fixes else None) for e in (hold, delta)]
        for k in range(65)
    ]
    assert answers[0][0].position[0] == answers[0][1].position[0] == 0.0
    assert [answers[k][0].position[0] for k in (1, 20, 21, 60, 61)] == [1.0, 1.0, 2.0, 2.0, 8.0]
    delay = sensors.delay * sensors.step
    assert answers[20][1].velocity[0] == 0.0
    assert answers[60][1].position[0] == pytest.approx(2.0 + (39 / 20 + delay) * 1.0)
    assert answers[64][1].velocity[0] == pytest.approx(3.0)
    assert answers[64][1].position[0] == pytest.approx(8.0 + (3 / 20 + delay) * 3.0)


@pytest.mark.parametrize("evaluation", ["superposed", "direct"])
def test_the_engines_give_equal_rows_without_nees_and_nis(evaluation: str) -> None:
    common = (*SHORT, ALL, "schemes=[MKF]", f"evaluation={evaluation}")
    fast = rows_of(configure(*common))
    slow = rows_of(configure(*common, "engine=reference"))
    assert fast.keys() == slow.keys()
    of_baselines = {key: row for key, row in fast.items() if key.scheme in BASELINES}
    assert {key.scheme for key in of_baselines} == set(BASELINES)
    assert {key.measure for key in of_baselines} == {"x", "y", "vx", "vy", "position", "velocity"}
    for key, row in of_baselines.items():
        scale = np.nanmax([abs(row[c]) for c in ("motion", "noise", "value")])
        for column in ("motion", "cross", "noise", "value"):
            other = slow[key][column]
            assert row[column] == pytest.approx(other, abs=1e-9 * scale, nan_ok=True), key


def test_superposed_is_direct() -> None:
    common = (*SHORT, ALL, "schemes=[MKF]")
    direct = rows_of(configure(*common, "evaluation=direct"))
    superposed = rows_of(configure(*common))
    for key, row in direct.items():
        parts = superposed[key._replace(amplitude=None)]
        assert key.amplitude is not None
        n = key.amplitude
        total = n**2 * parts["motion"] + 2 * n * parts["cross"] + parts["noise"]
        assert row["value"] == pytest.approx(total, rel=1e-9), key


def test_records_scatter_around_the_expectation(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cache, "folder", lambda: tmp_path / "cache")
    cache.KEPT.clear()
    common = [
        *SMALL, ALL, "schemes=[MKF]", "tuning=matched", f"results={tmp_path}", "normalise=rms",
        "record.duration=100", "grid.replicates=32", "grid.natural_period=[3.5,7]",
        "grid.amplitude=[0.02,0.7,10.0]",
    ]  # fmt: skip
    keys = ["scheme", "natural_period", "amplitude", "measure", "window"]
    records, found = (owtsweep.run([*common, f"engine={e}"]) for e in ("batch", "expected"))
    both = records.summary().merge(found.summary(), on=keys, suffixes=("", "_expected"))
    both = both[both["scheme"].isin(list(BASELINES))]
    assert len(both) == 3 * 2 * 3 * 6 * 2
    margin = 3.0 * (both["ci_high"] - both["mean"]) + 0.02 * both["mean"]
    assert ((both["mean_expected"] - both["mean"]).abs() < margin).all()
    # a motion of .02 m is below these sensors, one of 10 m is not: by records and by expectation
    for run in (records, found):
        best = run.best_scheme()
        best = best[best["criterion"] == "position"].set_index("amplitude")
        assert set(best["best"]) == {"MKF"}
        assert best.loc[0.02, "baseline_wins"].all()
        assert set(best.loc[0.02, "baseline"]) == {"NONE"}
        assert not best.loc[10.0, "baseline_wins"].any()
        assert (best["mse_baseline"] < best["mse_best"]).loc[0.02].all()
    tables = {"best_scheme": found.best_scheme()}
    figure = drawing.draw_map(found.config, tables, found.cases(), "position")
    assert "NONE" in [text.get_text() for text in figure.axes[0].texts]
    assert any("NONE: " in text.get_text() for text in figure.legends[0].get_texts())


def keys_of(config) -> dict[str, str]:
    study = HubStudy()
    return {block_key(study, block): block.label for block in plan_blocks(config)}


def test_one_shard_serves_all_tunings_and_no_hash_changes() -> None:
    paper, matched = (configure(ALL, tuning=tuning) for tuning in ("paper", "matched"))
    shared = keys_of(paper).keys() & keys_of(matched).keys()
    assert sorted(keys_of(paper)[key].split(",")[0] for key in shared) == sorted(BASELINES)
    without = configure("baselines=[]")
    assert keys_of(without).keys() == keys_of(paper).keys() - shared
    assert run_hash(without) == run_hash(paper)


def test_a_baseline_that_schemes_name_is_a_scheme() -> None:
    config = configure("schemes=[MKF,HOLD]", ALL)
    labels = [block.label.split(",")[0] for block in plan_blocks(config)]
    assert labels == ["MKF", "HOLD", "NONE", "DELTA"]
    expected = configure("schemes=[MKF,HOLD]", ALL, "engine=expected")
    assert [block.group for block in expected_engine.plan(expected)] == labels


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["baselines=[HOLD,HOLD]"], r"^baselines: HOLD stands there twice"),
        (["baselines=[MKF]"], r"^baselines\[0\]: 'MKF' is none of NONE, HOLD, DELTA"),
        (["baselines=HOLD"], r"^baselines: 'HOLD' is no list"),
        (
            ["schemes=[{_target_: user_schemes.HoldLastFix, name: HOLD}]", "baselines=[HOLD]"],
            r"^schemes: .*: the name 'HOLD' is that of a scheme of study=hub",
        ),
    ],
)
def test_what_is_refused(overrides: list[str], message: str) -> None:
    with pytest.raises(InputError, match=message):
        configure(*overrides)


def crowned(tmp_path: Path):
    run = owtsweep.run([
        *SMALL, ALL, "schemes=[MKF,HME1]", "tuning=matched", f"results={tmp_path}",
        "grid.replicates=6",
    ])  # fmt: skip
    return run, run.tables()


def test_maps_and_the_terminal_name_the_baseline(tmp_path: Path) -> None:
    run, tables = crowned(tmp_path)
    config, best = run.config, tables["best_scheme"]
    table, names, notes = describe.find_winners(config, best, "position", "full")
    assert names == ["MKF", "HME1", "NONE"]
    (note,) = notes
    assert note.startswith("NONE: an estimate of zero beats every scheme: no estimator needed")
    small = table[table["amplitude"] == 0.05].iloc[0]
    before = best[(best["amplitude"] == 0.05) & (best["criterion"] == "position")].iloc[0]
    assert (small["best"], small["runner_up"]) == ("NONE", before["best"])
    assert small["difference"] == pytest.approx(before["mse_best"] - before["mse_baseline"])
    console = Console(width=80, file=io.StringIO(), color_system=None)
    console.print(run.engine.terminal(config, tables))
    shown = console.file.getvalue()  # type: ignore[attr-defined]
    assert "NONE 1" in shown
    assert note in " ".join(shown.split())
    draw = run.engine.drawings(config, tables, run.cases(), {})
    assert "figure_18_best_scheme" in draw
    figure = mse_over_amplitude.draw(config, tables["summary"], 4.0)
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert legend[-3:] == ["NONE", "HOLD", "DELTA"]
    texts = " ".join(" ".join(text.get_text() for text in figure.findobj(Text)).split())
    assert "HOLD, the last fix, zero velocity" in texts


def test_a_baseline_of_less_error_is_named_and_hatched(tmp_path: Path) -> None:
    run, tables = crowned(tmp_path)
    best = tables["best_scheme"].assign(baseline_wins=False)
    table, names, notes = describe.find_winners(run.config, best, "position", "full")
    small = table[table["amplitude"] == 0.05].iloc[0]
    before = best[(best["amplitude"] == 0.05) & (best["criterion"] == "position")].iloc[0]
    assert (small["best"], small["runner_up"]) == ("NONE", before["best"])
    assert small["mse_best"] == before["mse_baseline"] < small["mse_runner_up"]
    assert not small["distinguishable"]
    assert names == ["MKF", "HME1", "NONE"]
    assert notes == [f"NONE: an estimate of zero {describe.UNDECIDED}."]
    assert best_scheme_map._describe_runner_up(small.to_dict()).startswith(f"{before['best']} +")
    shown = render(run, tables | {"best_scheme": best})
    assert re.search(r"0\.05 m +NONE +~", shown)
    assert "NONE in 1" in shown
    assert "beats every scheme" not in shown
    figure = listing.draw_cells(
        run.config, {"best_scheme": best}, run.cases(), "position", [], records="6 records per cell"
    )
    assert "NONE" in [text.get_text() for text in figure.axes[0].texts]


def test_an_answer_names_its_window_and_the_other(tmp_path: Path) -> None:
    run, tables = crowned(tmp_path)
    told = describe.tell_window("full")
    assert told in " ".join(render(run, tables).split())
    figure = listing.draw_cells(run.config, tables, run.cases(), "position", [])
    texts = " ".join(text.get_text() for text in figure.findobj(Text))
    assert told in " ".join(texts.split())


def test_a_scheme_of_a_user_that_is_best_nowhere_gets_a_line(tmp_path: Path) -> None:
    run, tables = crowned(tmp_path)
    name = "hold_the_last_fix_of_the_receiver"
    own = tables["ratios"].query("scheme == 'MKF'")
    tables["ratios"] = pd.concat([
        tables["ratios"], own.assign(scheme=name, error=own["error"] * 10.0)
    ])  # fmt: skip
    own_scheme = f"{{_target_: user_schemes.HoldLastFix, name: {name}}}"
    config = configure(f"schemes=[MKF,HME1,{own_scheme}]", ALL, tuning="matched")
    shown = " ".join(render(run, tables, config).split())
    least = 10.0 * own.query("criterion == 'position'")["error"].min()
    assert f"{name} is best in no cell: its error is {least:.3g} to " in shown
    assert "times the least, over 6 records of both." in shown
    assert "A = " not in shown
    assert re.search(r"cells: .*NONE 1", shown)


def test_the_settled_answer_has_the_bound_of_no_knowledge(tmp_path: Path) -> None:
    run, tables = crowned(tmp_path)
    settled = configure("schemes=[MKF,HME1]", "measures.window=settled", tuning="matched")
    bound = kalman_bounds(settled)["position"] ** 0.5
    said = "Bound: an estimator that assumes nothing of the motion has on average at least"
    assert f"{said} {bound:.3g} m." in " ".join(render(run, tables, settled).split())
    assert said not in " ".join(render(run, tables).split())  # the bound is that of settled records


def render(run, tables, config=None) -> str:
    console = Console(width=80, file=io.StringIO(), color_system=None)
    console.print(run.engine.terminal(config or run.config, tables))
    return console.file.getvalue()  # type: ignore[attr-defined]


def test_baselines_belong_to_every_tuning_and_are_in_both_maps(tmp_path: Path) -> None:
    words = [
        "schemes=[MKF,HME1]", "sensors.imu.rate=20", "record.duration=30", "grid.replicates=6",
        "measures.settling_time=5", "grid.natural_period=[4.0]", "grid.amplitude=[0.05,10.0]",
        "tuning=[paper,matched]", f"results={tmp_path}",
    ]  # fmt: skip
    run = owtsweep.run(words)
    assert run.config.baselines == list(BASELINES)  # by default
    plan = make_plan(run.study, run.config)
    tunings = {block.label.split(",")[0]: block.tunings for block in plan.values()}
    assert {tunings[name] for name in BASELINES} == {("paper", "matched")}
    assert len(plan) == len(list((run.folder / "cases").iterdir())) == 2 * 2 + len(BASELINES)
    results = run.make_results(run.stored()[0])
    figure = maps_by_tuning.draw(results)
    told = "NONE in 1"
    for axes, (tuning, result) in zip(figure.axes, results.items(), strict=True):
        alone = owtsweep.run([*words, f"tuning={tuning}", f"name={tuning}"]).best_scheme()
        assert set(alone["tuning"]) == {tuning}
        assert result.tables["best_scheme"].equals(alone.drop(columns="tuning"))
        written = [text.get_text() for text in axes.texts]
        assert written.count("NONE") == 1
        runners_up = [text for text in written if text.endswith(" %") or " x" in text]
        assert len(runners_up) == 2  # one in each cell
        assert told in " ".join(axes.get_title(loc="left").split())
        console = Console(width=80, file=io.StringIO(), color_system=None)
        console.print(run.engine.terminal(result.config, result.tables))
        assert told in " ".join(console.file.getvalue().split())  # type: ignore[attr-defined]
    assert [text.get_text() for text in figure.legends[0].get_texts()][-1] == "NONE"
    texts = " ".join(text.get_text() for text in figure.findobj(Text))
    assert "NONE: an estimate of zero" in " ".join(texts.split())
    assert RUNNER_UP in " ".join(texts.split())
    # the title of one narrow map stays beside its legend
    (name, result), *_ = results.items()
    narrow = maps_by_tuning.draw({name: result})
    narrow.draw_without_rendering()
    (title,) = (text for text in narrow.texts if text.get_text().startswith("Best scheme"))
    assert not title.get_window_extent().overlaps(narrow.legends[0].get_window_extent())


def test_baselines_change_no_verdict_on_the_schemes(tmp_path: Path) -> None:
    common = [
        *SMALL,
        "tuning=paper",
        "schemes=[MKF,HME1]",
        "grid.replicates=6",
        f"results={tmp_path}",
    ]
    without = owtsweep.run([*common, "name=without"]).best_scheme()
    beside = owtsweep.run([*common, ALL, "name=beside"]).best_scheme()
    of_baselines = {"baseline", "mse_baseline", "baseline_wins", "error_baseline"}
    assert {*beside.columns} == {*without.columns} | of_baselines
    assert beside[without.columns].equals(without)


def test_a_run_without_baselines_has_no_columns_of_theirs(tmp_path: Path) -> None:
    run = owtsweep.run([*SMALL, "baselines=[]", "schemes=[MKF]", f"results={tmp_path}"])
    assert not {"baseline", "mse_baseline", "baseline_wins"} & set(run.best_scheme().columns)
    assert set(run.summary()["scheme"]) == {"MKF"}
    assert math.isfinite(run.summary()["mean"].sum())
