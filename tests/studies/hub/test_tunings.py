"""Several tunings in one run: each is what it is alone, on the same records."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
import pytest

import owtsweep
from owtsweep.cli import main
from owtsweep.config import as_mapping, composition, dump
from owtsweep.errors import InputError
from owtsweep.studies import compose
from owtsweep.sweep.runs import Run

TINY = (
    "grid.natural_period=[4.0]", "grid.amplitude=[0.2,1.0]", "grid.replicates=2",
    "record.duration=30", "measures.settling_time=5", "sensors.imu.rate=20",
    "schemes=[MKF,HME1]", "baselines=[]", "compute.backend=threading",
)  # fmt: skip
BOTH = "tuning=[paper,matched]"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One run of both tunings, and a run of each alone."""
    folder = tmp_path_factory.mktemp("tunings")
    for name, tuning in {
        "both": BOTH,
        "paper": "tuning=paper",
        "matched": "tuning=matched",
    }.items():
        owtsweep.run([*TINY, tuning, f"results={folder}", f"name={name}"])
    return folder


@pytest.fixture
def both(folder: Path) -> Run:
    return owtsweep.load(folder / "both")


def test_the_papers_maps_have_both_tunings_each_composed_by_itself() -> None:
    config = compose(["experiment=paper"])
    assert list(config.by_tuning()) == ["paper", "matched"]
    for name, part in config.by_tuning().items():
        alone = compose(["experiment=paper", f"tuning={name}"])
        assert as_mapping(part) == as_mapping(alone)
        assert dump(part) == dump(alone)


def test_tables_are_those_of_each_tuning_alone(folder: Path, both: Run) -> None:
    for name in ("summary", "best_scheme"):
        table = both.table(name)
        assert next(iter(table)) == "tuning"
        for tuning in ("paper", "matched"):
            part = table[table["tuning"] == tuning].drop(columns="tuning")
            alone = owtsweep.load(folder / tuning).table(name)
            pd.testing.assert_frame_equal(part.reset_index(drop=True), alone, check_exact=True)
            of_part = both.by_tuning()[tuning].table(name)
            pd.testing.assert_frame_equal(of_part, alone, check_exact=True)


def test_shards_are_those_of_each_tuning_alone(folder: Path) -> None:
    shards = {
        name: {path.name: path.read_bytes() for path in (folder / name / "cases").iterdir()}
        for name in ("both", "paper", "matched")
    }
    assert shards["both"] == shards["paper"] | shards["matched"]


def test_the_plan_gives_a_row_its_tuning(folder: Path, both: Run) -> None:
    cases = both.cases()
    assert cases["tuning"].value_counts().to_dict() == dict.fromkeys(
        ("paper", "matched"), len(cases) // 2
    )
    alone = owtsweep.load(folder / "matched").cases()
    part = cases[cases["tuning"] == "matched"].drop(columns="tuning").reset_index(drop=True)
    pd.testing.assert_frame_equal(part, alone, check_exact=True)


@pytest.mark.parametrize("names", [[], ["paper", "nobody"], "paper", 3, [["paper"]]])
def test_a_forged_tuning_in_the_plan_is_refused(both: Run, names: object, tmp_path: Path) -> None:
    for file in ("config.yaml", "plan.json"):
        (tmp_path / file).write_bytes((both.folder / file).read_bytes())
    plan = json.loads((tmp_path / "plan.json").read_text())
    plan["blocks"][0][4] = names
    (tmp_path / "plan.json").write_text(json.dumps(plan))
    with pytest.raises(InputError, match="this is no plan of a run"):
        owtsweep.load(tmp_path)


def test_figures_carry_the_tuning(both: Run) -> None:
    results = both.make_results(both.stored()[0])
    (png, _) = both.draw("best_scheme_maps", results)
    assert png.name == "best_scheme_maps.png"
    drawn = {path.name for path in both.draw("figure_15_mse_4s", results) if path.suffix == ".png"}
    assert drawn == {"figure_15_mse_4s_paper.png", "figure_15_mse_4s_matched.png"}
    assert len(both.draw("figure_03_record", results)) == 2  # a PNG and an SVG, of no tuning


def test_tunings_of_one_run_are_compared(both: Run, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", str(both.folder)]) == 0
    told = capsys.readouterr().out
    assert "paper" in told
    assert "matched" in told


def test_a_multirun_runs_both_tunings_each_time(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Run, "draw", lambda *_, **__: [])  # test_figures_carry_the_tuning
    words = [*TINY, "grid.amplitude=[1.0]", BOTH]
    words += ["--multirun", "sensors.gnss.delay=0.1,0.2"]
    assert main(["sweep", *words]) == 0
    tables = [pd.read_csv(path) for path in tmp_path.glob("results/*/*/best_scheme.csv")]
    assert [set(table["tuning"]) for table in tables] == [{"paper", "matched"}] * 2


@pytest.mark.parametrize(
    ("override", "told"),
    [
        ("hme1.q_a=2.0", r"^hme1\.q_a: this would change several tunings \(paper, matched\)"),
        ("hme={smoother_window: 3}", r"^hme: this would change several tunings"),
        ("hme1.qa=2.0", "q_a"),
        ("tuning=[paper,nobody]", "nobody"),
    ],
)
def test_an_override_of_one_tunings_key_is_refused(override: str, told: str) -> None:
    with pytest.raises(InputError, match=told):
        compose([BOTH, override] if "tuning" not in override else [override])


def test_bounds_of_the_mhe_belong_to_all_tunings() -> None:
    config = compose([BOTH, "hme.mhe.constraints.bias=0.3"])
    bounds = [part.hme.mhe.bounds[2] for part in config.by_tuning().values()]  # type: ignore[attr-defined]
    assert bounds == [0.3, 0.3]


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ("tuning: paper", "two of the files paper, mine set tuning: paper"),
        ("tuning: mine\nseed: 3", "paper and mine differ in seed"),
        ("tuning: my/own", "cannot be part of a file's name"),
    ],
)
def test_tunings_that_cannot_share_a_run_are_refused(
    change: str, told: str, tmp_path: Path
) -> None:
    own = Path(__file__).parents[3] / "conf/tuning/matched.yaml"
    (tmp_path / "tuning").mkdir()
    text = own.read_text().replace("tuning: matched", change)
    (tmp_path / "tuning/mine.yaml").write_text(text)
    with pytest.raises(InputError, match=told):
        compose(["tuning=[paper,mine]"], str(tmp_path))


def test_one_tuning_by_name_is_composed_in_one_pass(monkeypatch: pytest.MonkeyPatch) -> None:
    several = compose(["tuning=[matched]"])
    monkeypatch.delattr(composition, "find_options")
    assert compose(["tuning=matched"]) == compose([]) == several
    with pytest.raises(InputError, match="there is no 'nope'"):
        compose(["tuning=nope"])
