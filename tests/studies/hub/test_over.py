"""A run over worlds against separate runs whose truth departs while schemes are told the same."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import owtsweep
from owtsweep.errors import InputError
from owtsweep.sweep.runs import Run

SMALL = [
    "record.duration=60", "measures.settling_time=20", "sensors.imu.rate=50",
    "grid.natural_period=[4,6]", "grid.amplitude=[0.2,2]", "grid.replicates=2",
    "schemes=[MKF,HME1,HME2,SKF]", "compute=single",
]  # fmt: skip
KEYS = ["natural_period", "amplitude", "scheme", "measure", "window", "replicate"]
VALUES = ["motion", "cross", "noise", "value"]


def run(folder: object, *words: str) -> Run:
    return owtsweep.run([*SMALL, f"results={folder}", *words])


def list_rows(made: Run, world: str = "nominal") -> pd.DataFrame:
    rows = made.stored(world)[0][""]
    return rows.astype({"scheme": str, "measure": str, "window": str}).set_index(KEYS)[VALUES]


@pytest.fixture(scope="module")
def nominal(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run(tmp_path_factory.mktemp("nominal"))


#: World -> overrides of a run that is so, and whose schemes are told what those of the run over
#: worlds are: no filter is told of outliers, red noise or another spectrum, and a tilt is told as
#: `tilt` of each section.
ALONE = {
    "outliers_5": ["sensors.gnss.outliers.rate=0.05"],
    "multipath": ["sensors.gnss.outliers.rate=0.05", "sensors.gnss.outliers.length=5"],
    "red_fixes": [
        "sensors.gnss.correlation.sigma=0.1",
        "sensors.gnss.correlation.time=300",
    ],
    "two_peaks": ["motion.peaks=[0.1,0.26]"],
    "drifting_period": ["motion.pace=[[0,1],[60,1.1111111111111112]]"],
    "plant_seas": ["structure=ren2019", "motion.hs=[2]", "motion.tp=[8]"],
    "leaning_out": [
        "sensors.imu.tilt=0.0137", "ekf.tilt=0", "mkf.tilt=0", "hme1.tilt=0", "hme2.tilt=0",
        "skf.tilt=0",
    ],
}  # fmt: skip


@pytest.fixture(scope="module")
def over(tmp_path_factory: pytest.TempPathFactory) -> Run:
    return run(tmp_path_factory.mktemp("over"), f"over={{world: [nominal,{','.join(ALONE)}]}}")


def test_the_nominal_world_is_a_run_without_over(nominal: Run, over: Run) -> None:
    assert over.hash == nominal.hash
    assert set(nominal.plan()) < set(over.plan())
    pd.testing.assert_frame_equal(over.cases(), nominal.cases())
    pd.testing.assert_frame_equal(over.summary(), nominal.summary())
    pd.testing.assert_frame_equal(over.best_scheme(), nominal.best_scheme())


@pytest.mark.parametrize("world", ALONE)
def test_a_world_is_a_run_whose_truth_is_so_and_whose_schemes_know_nothing_of_it(
    over: Run, world: str, tmp_path: object
) -> None:
    words, found = ALONE[world], list_rows(over, world)
    if any(word.startswith(("motion.", "structure=")) for word in words):
        words = [*words, "schemes=[MKF,HME1,HME2]"]  # SKF is told the spectrum, and refuses others
        found = found[found.index.get_level_values("scheme") != "SKF"]
    pd.testing.assert_frame_equal(found, list_rows(run(tmp_path, *words)))


def test_regret_is_that_of_separate_runs(
    nominal: Run, over: Run, tmp_path_factory: pytest.TempPathFactory
) -> None:
    runs = {"nominal": nominal, "outliers_5": run(tmp_path_factory.mktemp("o"),
                                                  *ALONE["outliers_5"])}  # fmt: skip
    found = over.regret().set_index(["world", "natural_period", "amplitude", "scheme"])
    for world, each in runs.items():
        summary = each.summary().query("measure == 'position' and window == 'settled'")
        for (period, amplitude), cell in summary.groupby(["natural_period", "amplitude"]):
            error = np.sqrt(cell.set_index("scheme")["mean"])
            assert {"NONE", "HOLD", "DELTA", "SKF"} < {*error.index}
            for scheme, value in error.items():
                line = found.loc[(world, period, amplitude, scheme)]
                assert line["error"] == pytest.approx(value, rel=1e-9)
                assert line["regret"] == pytest.approx(value / error.min(), rel=1e-9)
    mean = over.regret().groupby(["natural_period", "amplitude", "scheme"])["regret"].mean()
    summary = over.table("regret_summary").set_index(["natural_period", "amplitude", "scheme"])
    pd.testing.assert_series_equal(summary["mean"].sort_index(), mean, check_names=False)


@pytest.mark.parametrize(
    "unknown",
    ["sensors.gnss.delay: [0.6]", "sensors.gnss.sigma: [0.09]", "sensors.imu.sigma: [0.3]",
     "sensors.imu.high_pass: [0.01]", "sensors.gnss.scale: [1.02]"],
)  # fmt: skip
def test_kernels_and_steps_agree_in_a_world_that_departs(
    unknown: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    words = ["grid.natural_period=[4]", "grid.amplitude=[0.5]", "grid.replicates=1",
             "record.duration=12", "measures.settling_time=4", "schemes=[MKF,HME1]",
             f"over={{{unknown}}}"]  # fmt: skip
    world = unknown.replace(": [", "=").removesuffix("]")
    batch, steps = (
        run(tmp_path_factory.mktemp(engine), *words, f"engine={engine}", "evaluation=direct")
        for engine in ("batch", "reference")
    )
    columns = ["value"]
    first, second = (list_rows(each, world)[columns] for each in (batch, steps))
    assert not np.allclose(first, list_rows(batch)[columns])
    pd.testing.assert_frame_equal(first, second, rtol=1e-6)


def test_fixes_that_only_the_truth_loses_are_lost_step_by_step(tmp_path: object) -> None:
    words = ["grid.natural_period=[4]", "grid.amplitude=[0.5]", "schemes=[MKF]", "baselines=[]"]
    lost = run(tmp_path, *words, "over={sensors.gnss.loss.probability: [0, 0.2]}")
    alone = run(tmp_path, *words, "sensors.gnss.loss.probability=0.2")
    world = "sensors.gnss.loss.probability=0.2"
    pd.testing.assert_frame_equal(list_rows(lost, world), list_rows(alone))
    assert [*lost.regret()["world"].unique()] == ["sensors.gnss.loss.probability=0", world]


def test_a_stored_run_is_read_and_drawn_without_planning(over: Run) -> None:
    read = owtsweep.load(over.folder)
    pd.testing.assert_frame_equal(read.regret(), over.regret())
    assert set(read.plan()) == set(over.plan())
    pd.testing.assert_frame_equal(list_rows(read, "two_peaks"), list_rows(over, "two_peaks"))
    assert {path.name for path in read.draw("regret_mean")} >= {"regret_mean.png"}
    assert {path.name for path in read.draw("regret_worst")} >= {"regret_worst.png"}
    page = read.write_report().read_text()
    assert "If nobody knows the world (over 8 worlds, equal weights)" in page
    assert "Regret over what nobody knows" in page


def test_further_worlds_share_the_folder_and_what_is_computed(over: Run) -> None:
    from owtsweep.studies import compose, get_study
    from owtsweep.sweep.run import sweep

    words = [*SMALL, f"results={over.folder.parent}", "over={world: [outliers_5,outliers_1]}"]
    outcome = sweep(get_study("hub"), compose(words))
    cases = len(over.plan()) // 8
    assert outcome.run.folder == over.folder
    assert outcome.computed * 3 == outcome.computed + outcome.reused
    assert cases > 0
    assert [*outcome.run.regret()["world"].unique()] == ["outliers_5", "outliers_1"]


@pytest.mark.parametrize(
    ("words", "line"),
    [
        (["structure=ren2019"], "motion.hs: it has 0 values, and with motion=spectrum"),
        (
            ["structure=ren2019", "motion.hs=[1,2]", "motion.tp=[8]"],
            "motion.hs: it has 2 values, and with motion=spectrum the structure moves in one sea",
        ),
        (["motion.peaks=[0.9]"], "motion.peaks: 0.9 Hz lies outside band [0.05, 0.6] Hz"),
        (["motion.pace=[[0,-1]]"], "motion.pace: the factor -1 at 0 s is not above zero"),
        (["motion.pace=[[0,1]]", "engine=expected"], "motion.pace: engine=expected needs"),
        (["motion=plant", "+motion.peaks=[0.1]"], "motion.peaks: the sea of motion=plant"),
    ],
)
def test_motions_that_cannot_be_are_refused(words: list[str], line: str) -> None:
    with pytest.raises(InputError) as caught:
        owtsweep.studies.compose(words)
    assert str(caught.value).startswith(line)


def test_the_default_answer_quotes_the_stored_sweep_over_worlds() -> None:
    from owtsweep.studies import compose
    from owtsweep.studies.hub.describe import quote_worlds

    (line,) = quote_worlds(compose([]))
    assert line.startswith("If the world is another one, by a stored sweep of 9 cells of its own")
    assert "(4 6 8 s; 10 worlds, `owtsweep sweep experiment=worlds`, 2026-" in line
    assert "times the least error, in red_fixes" in line
    for other in (
        ["experiment=worlds"], ["sensors=strong_bias"], ["tuning=paper"], ["motion=plant"],
        ["motion.pace=[[0,1.1]]"],
    ):  # fmt: skip
        assert quote_worlds(compose(other)) == []
