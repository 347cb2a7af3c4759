"""Users' schemes in the declared studies: named, run, isolated, stored, refused in one line."""

from __future__ import annotations

import re
import sys
from importlib.metadata import EntryPoint
from pathlib import Path

import own_schemes
import pytest
from small_tower import SMALL_TOWER

import owtsweep
from owtsweep import load
from owtsweep.cli import main
from owtsweep.errors import InputError
from owtsweep.studies import compose, get_study
from owtsweep.studies.base import schemes
from owtsweep.studies.hub.contract import SCHEMES
from owtsweep.testing import check_scheme

TINY = [
    "study=floater", "record.duration=60", "record.rate=10", "record.settling=20",
    "grid.delay=[0,2]", "grid.bias=[0.1]", "grid.replicates=2", "compute=single",
]  # fmt: skip
#: Study -> the overrides with which its schemes are checked: short records, but of the hub.
SHORT = {
    # A short window, which is full before the record ends.
    "hub": [
        "tuning=matched", "hme.mhe.horizon=3", "hme.mhe.smoother_window=3", "skf.states=6",
    ],
    "floater": ["record.duration=60", "record.rate=10", "record.settling=20"],
    "blade": ["record.duration=60", "record.settling=20", "grid.outage=[0]"],
    "tower": SMALL_TOWER,
}  # fmt: skip
#: All schemes but NONE, whose estimate is zero whatever the data.
OURS = [(study, name) for study in SHORT for name in get_study(study).schemes() if name != "NONE"]


@pytest.fixture(autouse=True)
def _elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def own(name: str) -> str:
    return f"{{_target_:own_schemes.{name}}}"


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize(("study", "name"), OURS)
def test_all_of_ours_keep_the_contract(study: str, name: str) -> None:
    table = SCHEMES if study == "hub" else get_study(study).declaration().schemes
    check_scheme(table.resolve(name), SHORT[study])


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("Nameless", "Nameless: it lacks name"),
        ("Short", r"SHORT: position has the shape \(599, 6\), not \(600, 6\)"),
        ("Forgetful", "FORGETFUL: run changes the measurements"),
    ],
)
def test_a_broken_scheme_is_found(name: str, says: str) -> None:
    with pytest.raises(AssertionError, match=says):
        check_scheme(getattr(own_schemes, name)(), SHORT["floater"])


def test_a_sound_scheme_passes() -> None:
    check_scheme(own_schemes.Held(), SHORT["floater"])
    check_scheme(own_schemes.Refuses(), SHORT["floater"])


def test_a_users_scheme_runs_beside_ours_and_its_errors_are_its_own() -> None:
    names = ["Held", "Exits", "Short", "Nan", "Refuses"]
    entries = ",".join(["LOWPASS", *map(own, names)])
    in_processes = ["compute=local", "compute.workers=1"]
    assert main(["sweep", *TINY, *in_processes, "name=mine", f"schemes=[{entries}]"]) == 1
    rows = load("results/mine").cases()
    told = rows.groupby("scheme", observed=True)[["status", "reason"]].first()
    assert told.loc[["LOWPASS", "HELD"], "status"].tolist() == ["ok", "ok"]
    assert told.loc["EXITS"].tolist() == ["failed", "SystemExit: 3"]
    assert told.loc["SHORT", "reason"] == "position has the shape (599, 6), not (600, 6)"
    assert told.loc["NAN"].tolist() == ["failed", "the estimate is not finite"]
    assert told.loc["REFUSES"].tolist() == ["unable", "no reports on Sundays"]
    summary = load("results/mine").summary()
    position = summary[summary["measure"] == "position"].set_index("scheme")["mean"]
    assert position["HELD"].max() < position["LOWPASS"].max()


def test_a_users_scheme_that_is_best_nowhere_has_its_line(
    capsys: pytest.CaptureFixture[str],
) -> None:
    assert main(["sweep", *TINY, "name=mine", f"schemes=[KF,LOWPASS,{own('Held')}]"]) == 0
    best = load("results/mine").best_scheme()
    text = " ".join(capsys.readouterr().out.split())
    criterion = best[best["criterion"] == "velocity"]
    assert ("HELD" in set(criterion["best"])) != ("HELD is best in no cell: its error is" in text)
    assert "LOWPASS is best in no cell" not in text


def test_a_users_scheme_of_the_tower_fails_alone() -> None:
    words = ["study=tower", *SHORT["tower"], "grid.noise=[1]", "grid.soil_factor=[1]"]
    entries = f"schemes=[QUASI_STATIC,{own('Falls')}]"
    assert main(["sweep", *words, "grid.replicates=1", "compute=single", entries]) == 1
    rows = load(next(Path("results").iterdir())).cases().groupby("scheme", observed=True)
    told = rows[["status", "reason"]].first()
    assert told.loc["QUASI_STATIC", "status"] == "ok"
    assert told.loc["FALLS"].tolist() == ["failed", "ZeroDivisionError: division by zero"]


def test_the_example_of_the_page_keeps_the_contract() -> None:
    page = (Path(__file__).parents[2] / "CONTRIBUTING.md").read_text("utf-8")
    (example,) = re.findall(r"```python\n(import numpy[^`]*class Held.*?)```", page, re.DOTALL)
    names: dict[str, type] = {}
    exec(example, names)
    check_scheme(names["Held"](), SHORT["floater"])


def test_another_package_has_a_scheme_of_the_hub(monkeypatch: pytest.MonkeyPatch) -> None:
    points = [EntryPoint("hold", "user_schemes:HoldLastFix", "owtsweep.schemes")]
    monkeypatch.setattr(schemes, "entry_points", lambda group: points)
    study, config = (
        get_study("hub"),
        compose(["schemes=[hold,MKF]", "grid=small", "tuning=matched"]),
    )
    assert study.engine(config).plan(config)[0].content["entry"] == "hold"


def test_a_scheme_of_another_package(monkeypatch: pytest.MonkeyPatch) -> None:
    points = [EntryPoint("HELD", "own_schemes:Held", "owtsweep.schemes")]
    monkeypatch.setattr(schemes, "entry_points", lambda group: points)
    study, config = get_study("floater"), compose([*TINY, "schemes=[HELD,KF]"])
    assert study.schemes()["HELD"] == "own_schemes:Held, of another package"
    theirs, ours = study.engine(config).plan(config)[:2]
    assert theirs.content["entry"] == "HELD"
    assert "source" in theirs.content
    assert "entry" not in ours.content
    points[:] = [EntryPoint("WRONG", "own_schemes:Held", "owtsweep.schemes")]
    with pytest.raises(InputError, match="own_schemes:Held calls itself 'HELD', its package"):
        compose([*TINY, "schemes=[WRONG]"])


def test_a_stored_run_is_read_without_the_users_code(monkeypatch: pytest.MonkeyPatch) -> None:
    words = [*TINY, "name=mine", f"schemes=[LOWPASS,{own('Held')}]"]
    owtsweep.run(words)
    monkeypatch.setitem(sys.modules, "own_schemes", None)
    run = load("results/mine")
    assert set(run.summary()["scheme"]) == {"LOWPASS", "HELD"}
    assert main(["figures", "results/mine"]) == 0
    assert main(["show", "results/mine"]) == 0


@pytest.mark.parametrize(
    ("entry", "says"),
    [
        ("{_target_:own_schemes.Taken}", "the name 'KF' is that of a scheme of study=floater"),
        ("{_target_:own_schemes.Other}", "is a scheme of study=blade, not of study=floater"),
        ("{_target_:own_schemes.Nameless}", r"is no scheme: it lacks name \(a non-empty str\)"),
        (
            "{_target_:own_schemes.Unable}",
            "no class that derives from owtsweep.schemes.floater.S",
        ),
        ("{_target_:own_schemes.None}", "own_schemes.None cannot be made"),
        ("{_target_:nobody.Wrote}", "nobody.Wrote cannot be made"),
        ("{_target_:Wrote}", "names no class; use"),
        ("{name:3}", "is neither a name nor"),
        ("MEKF", r"there is no scheme 'MEKF' here \(but in study=blade and study=mating\)"),
        ("KF,KF", "'KF' stands there twice"),
    ],
)
def test_what_is_no_scheme_is_refused_in_one_line(
    entry: str, says: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["sweep", *TINY, f"schemes=[{entry}]"]) == 2
    told = capsys.readouterr().err
    assert re.fullmatch(rf"owtsweep: schemes.*{says}.*\n", told), told


def test_code_is_part_of_the_key() -> None:
    study = get_study("floater")
    config = compose([*TINY, f"schemes=[{own('Held')},KF]"])
    mine, ours = study.engine(config).plan(config)[:2]
    assert mine.content["entry"] == {"_target_": "own_schemes.Held"}
    assert {"source"} <= set(mine.content)
    assert "source" not in ours.content
