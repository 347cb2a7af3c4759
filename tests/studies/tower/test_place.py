"""The command `place`, and the set-up of a choice for a structure of the user's."""

from __future__ import annotations

from itertools import combinations
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import yaml

from experiments.tower.placement import simulate
from owtsweep.cli import BAD_INPUT, DONE, INTERRUPTED, main
from owtsweep.structures import find_structure
from owtsweep.structures.bernoulli import assemble_cut
from owtsweep.studies.registry import compose
from owtsweep.studies.tower.placement import pose, predict
from owtsweep.studies.tower.placement_case import divide_tubes, make_case
from owtsweep.studies.tower.placing import list_defaults
from owtsweep.studies.tower.truth import make_truth

SHORT = ["record.duration=30", "record.settling=10"]
MONOPILE = ["study=tower", "structure=oc3_monopile", *SHORT]
HEIGHTS = (10.0, 25.0, 40.0, 60.0, 90.0, 107.0)


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def place(*words: str) -> int:
    return main(["place", *MONOPILE, *words])


def read() -> pd.DataFrame:
    (path,) = Path("results").glob("place-*/place.csv")
    return pd.read_csv(path)


@pytest.mark.parametrize(("quantity", "unit"), [("stress", "MPa"), ("base_moment", "MN m")])
def test_it_says_how_many_and_where(quantity, unit, capsys):
    words = ["--heights", ",".join(map(str, HEIGHTS)), "--quantity", quantity, "--count", "5"]
    assert place(*words) == DONE
    told, table = capsys.readouterr().out, read()
    written = {path.name for path in Path("results").glob("place-*/*")}
    assert written == {"place.csv", "configuration.yaml"}
    assert list(table["inclinometers"]) == [3, 4, 5]
    assert "one more lowers the standard deviation of the error of" in " ".join(told.split())
    assert f"σ ({unit})" in told
    assert "Truth: oc3_monopile, wind 8 m/s, no waves, 30 s, fore-aft." in told
    assert "Noise: 1 % of each signal's standard deviation" in told
    assert "Tuning paper" in told
    assert "It is no record" in told
    (stored,) = Path("results").glob("place-*/configuration.yaml")
    sensors = yaml.safe_load(stored.read_text())["sensors"]
    assert (len(sensors["accelerometers"]), sensors["every_node"]) == (5, [])

    # brute force: the best of all sets of three, then the best of all additions
    structure = find_structure("oc3_monopile")
    config = compose([*MONOPILE, *list_defaults(())])
    divided = divide_tubes(structure, (structure.hub - structure.mudline) / 13, HEIGHTS)
    config = config.model_copy(update={"structure": divided})
    problem = pose(make_case(config, inclinometers=HEIGHTS, spread=True))
    criterion = "moment" if quantity == "base_moment" else "stress"
    errors = {
        chosen: predict(problem, chosen).error(criterion)
        for count in (3, 4, 5, 6)
        for chosen in combinations(range(6), count)
    }
    best = min((c for c in errors if len(c) == 3), key=errors.__getitem__)
    for row in table.itertuples():
        assert row.share == pytest.approx(errors[best], rel=1e-9)
        assert row.heights == " ".join(f"{HEIGHTS[n]:g}" for n in best)
        further = [c for c in errors if len(c) == len(best) + 1 and set(best) < set(c)]
        added = min(further, key=errors.__getitem__)
        assert row.next_lowers == pytest.approx(1.0 - errors[added] / errors[best], rel=1e-6)
        assert row.next_height == HEIGHTS[(set(added) - set(best)).pop()]
        best = added


def test_sensors_that_the_user_names_are_there_already(capsys):
    named = ["sensors.inclinometers=[30]", "sensors.accelerometers=[30,107.6]"]
    words = ["--heights", "10,50,80,107", "--count", "3"]
    assert place(*named, *words) == DONE
    told = capsys.readouterr().out
    assert "There already: inclinometers at 30 m; accelerometers at 30, 107.6 m." in told
    assert "a sweep on records needs the end of a tube at each" in " ".join(told.split())
    assert " more inclinometers are" in told
    assert list(read()["inclinometers"]) == [2, 3]
    assert place(*named, "--heights", "10,30,80") == BAD_INPUT
    assert "an inclinometer is there already 30 m above the ground" in capsys.readouterr().err


def test_nothing_is_written_if_it_is_stopped_or_cannot_write(tmp_path, capsys, monkeypatch):
    (tmp_path / "file").write_text("")
    assert place(f"results={tmp_path / 'file'}") == BAD_INPUT
    assert capsys.readouterr().err.startswith("owtsweep: results: ")

    def stopped(*words, **options):
        raise KeyboardInterrupt

    monkeypatch.setattr("owtsweep.studies.tower.placing.choose_greedily", stopped)
    assert place(f"results={tmp_path / 'r'}") == INTERRUPTED
    assert capsys.readouterr().err == "owtsweep: interrupted; nothing is written\n"
    assert not (tmp_path / "r").exists()


def test_heights_that_are_all_needed_are_not_called_enough(capsys):
    words = ["--heights", "20,60,107", "--quantity", "base_moment"]
    assert place(*words) == DONE
    told = capsys.readouterr().out
    assert told.startswith("Three inclinometers are needed, at 20, 60, 107 m; no height is left")
    assert read()["next_height"].isna().all()


def test_waves_are_one_load_more(capsys):
    words = ["sea=waves", "--heights", "10,25,40,60,107"]
    assert place(*words, "--count", "3") == BAD_INPUT
    assert "no 3 of the candidate heights let the filter see all loads" in capsys.readouterr().err
    assert place(*words) == DONE
    assert "AKF_WAVE" in capsys.readouterr().out
    assert list(read()["inclinometers"]) == [4, 5]


@pytest.mark.parametrize(
    ("words", "reason"),
    [
        (["study=hub"], "study: `place` serves tower only, not 'hub'"),
        (["study=blade"], "study: `place` serves tower only, not 'blade'"),
        ([], "study: `place` serves tower only, not 'hub'"),
        (["study=towr"], "study: there is no study 'towr'; did you mean tower?"),
        ([*MONOPILE, "--quantity", "momnt"], "--quantity: there is no 'momnt'; did you mean"),
        ([*MONOPILE, "--count", "0"], "--count: 0 sensors are none"),
        ([*MONOPILE, "--count", "x"], "argument --count: invalid int value: 'x'"),
        ([*MONOPILE, "--count", "2"], "--count: no 2 of the candidate heights let the filter see"),
        ([*MONOPILE, "--count", "99"], "--count: 99 inclinometers, but there are 15 candidate"),
        (
            [*MONOPILE, "--count", "4", "--heights", "10,40,80"],
            "--count: 4 inclinometers, but there are 3 heights",
        ),
        ([*MONOPILE, "--heights", "10,top"], "--heights: '10,top' is no list of heights"),
        ([*MONOPILE, "--heights", "10,nan"], "--heights: '10,nan' is no list of heights"),
        ([*MONOPILE, "--heights", "10,40,10"], "--heights: 10 m stands there twice"),
        ([*MONOPILE, "--heights", "10,10.001,40"], "--heights: 10 and 10.001 m are one place"),
        ([*MONOPILE, "--heights", "10,40,500"], "--heights: 500 m is outside; give heights above"),
        ([*MONOPILE, "--heights", "0,40,80"], "--heights: nothing moves at 0 m above the ground"),
        ([*MONOPILE, "structure=nowhere"], "structure: there is no 'nowhere'; use"),
        ([*MONOPILE, "cuts=[0,50]"], "cuts: the high one at 50 m above the ground is inside an"),
        ([*MONOPILE, "sensors=dry"], "sensors.inclinometers: no node of the mesh is 45 m above"),
        ([*MONOPILE, "grid.noise=[1,3]"], "grid.noise: `place` takes one noise"),
        ([*MONOPILE, "grid.noise=[0]"], "grid.noise: 0 % makes the covariance R"),
        ([*MONOPILE, "tuning=[paper,matched]"], "tuning: `place` takes one tuning; name one"),
        ([*MONOPILE, "schemes=[GDF]"], "schemes: `place` does not take it, because its answer"),
        ([*MONOPILE, "fatigue.curve=paper"], "fatigue.curve: `place` does not take it"),
        ([*MONOPILE, "faults.bias=0.1"], "model and faults: the AKF's covariance does not know"),
        ([*MONOPILE, "model.stiffness=0.8"], "wrong (stiffness x 0.8)"),
        ([*MONOPILE, "recorded.file=m.csv"], "recorded.file: `place` does not take it"),
        ([*MONOPILE, "name=x"], "name: `place` names its folder by the query"),
        ([*MONOPILE, "wind.thurst.mean=1"], "wind.thurst"),
    ],
)
def test_bad_input_is_one_line(words, reason, capsys):
    assert main(["place", *words]) == BAD_INPUT
    out, err = capsys.readouterr()
    assert (out, len(err.splitlines())) == ("", 1)
    assert reason in err
    assert not Path("results").exists()


def test_divided_tubes_are_the_same_structure():
    whole = find_structure("oc3_monopile")
    parts = divide_tubes(whole, 5.0, [25.5])
    parts.check()
    ends = assemble_cut(parts, parts.mudline, parts.hub).heights - parts.mudline
    assert np.diff(ends).max() <= 5.0 + 1e-9
    assert 25.5 in ends
    coarse, fine = (
        assemble_cut(s, whole.mudline, whole.hub, subdivision=n)
        for s, n in ((whole, 64), (parts, 2))
    )
    lean = np.zeros(len(coarse.mass)), np.zeros(len(fine.mass))
    for beam, shape in zip((coarse, fine), lean, strict=True):
        shape[0::2], shape[1::2] = beam.heights**2, 2.0 * beam.heights
    for matrix in ("mass", "stiffness"):
        energies = [
            shape @ getattr(beam, matrix) @ shape
            for beam, shape in zip((coarse, fine), lean, strict=True)
        ]
        assert energies[0] == pytest.approx(energies[1], rel=1e-9)


def test_what_is_predicted_to_be_better_is_better_on_records():
    config = compose(
        ["study=tower", "tuning=paper", "sensors=accelerometers", "grid.noise=[1]", *SHORT]
    )
    case, motions = make_case(config), [make_truth(config, 0)["fa"]]
    problem = pose(case)
    heights = list(problem.heights)
    for criterion, good, bad in (("stress", (0, 136, 175), (20, 35, 40)),
                                 ("moment", (0, 15, 45), (123, 149, 175))):  # fmt: skip
        said, found = [], []
        for places in (good, bad):
            chosen = [heights.index(place) for place in places]
            said.append(predict(problem, chosen).error(criterion))
            errors = simulate(case, motions, chosen, config.record.settled)
            found.append(errors[criterion == "moment"])
        assert said[0] < 0.5 * said[1]
        assert found[0] < 0.5 * found[1]
        # of one size; the truth is no random walk, so not more
        assert np.all(np.abs(np.log2(np.array(found) / said)) < 1.5)
