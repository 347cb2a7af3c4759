"""Several questions in one run folder: each keeps its tables and figures, the root has the last."""

from __future__ import annotations

import json
import os

import pandas as pd
import pytest

from owtsweep.api import load
from owtsweep.cli.program import main
from owtsweep.config import dump
from owtsweep.errors import InputError
from owtsweep.io import files
from owtsweep.sweep import asked
from owtsweep.sweep.keys import question_hash, run_folder
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.run import sweep

MANY, FEW = {"level": [1.0, 2.0, 0.3]}, {"level": [5.0], "schemes": ["A"]}


def own(c):
    return run_folder(c) / "asked" / question_hash(c)


def names(folder):
    return sorted(path.name for path in folder.iterdir())


def levels(folder):
    return set(pd.read_csv(folder / "summary.csv")["level"])


def test_each_question_keeps_its_tables_and_figures(known_study, config):
    many, few = config(**MANY), config(**FEW)
    first = sweep(known_study, many).run
    first.draw()
    (first.folder / "figures" / "stale.png").write_text("of the first question")
    for name in ("notes.txt", "notes.csv"):
        (first.folder / name).write_text("the user's")
    second = sweep(known_study, few).run
    assert second.folder == first.folder
    root = second.folder
    assert levels(root) == levels(own(few)) == {5.0}
    assert levels(own(many)) == {1.0, 2.0, 0.3}
    assert names(own(many)) == [
        "config.yaml", "figures", "manifest.json", "order.csv", "plan.json", "summary.csv",
    ]  # fmt: skip
    assert names(own(many) / "figures") == ["means.csv", "stale.png"]
    assert not (root / "figures").exists()
    assert {"notes.txt", "notes.csv"} <= set(names(root))
    assert set(first.summary()["level"]) == {1.0, 2.0, 0.3}  # of a run that Python still holds
    assert [path.parent.parent for path in first.draw()] == [own(many)]
    second.draw()
    assert names(root / "figures") == names(own(few) / "figures") == ["means.csv"]
    pd.testing.assert_frame_equal(load(own(many)).cases(), first.cases())


def test_an_opened_question_is_the_run_that_was_asked(known_study, config):
    many, few = config(**MANY), config(**FEW)
    before = sweep(known_study, many).run.summary()
    sweep(known_study, few)
    opened = load(own(many))
    assert opened.config == many
    pd.testing.assert_frame_equal(opened.summary(), before)
    assert opened.draw() == [own(many) / "figures" / "means.csv"]
    assert not (run_folder(many) / "figures").exists()
    assert main(["show", str(own(many))]) == 0
    again = sweep(known_study, many)
    assert (again.computed, again.reused) == (0, 12)
    assert levels(run_folder(many)) == {1.0, 2.0, 0.3}


def test_an_earlier_question_asked_again_is_the_latest_with_all_its_files(known_study, config):
    many, few = config(**MANY), config(**FEW)
    first = sweep(known_study, many).run
    (first.folder / "fidelity").mkdir()
    (first.folder / "fidelity" / "fidelity.html").write_text("of many")
    first.draw()
    before = (first.folder / "figures" / "means.csv").read_bytes()
    spent = json.loads((first.folder / "manifest.json").read_text())["blocks"]["each"]
    sweep(known_study, few).run.draw()
    assert not (first.folder / "fidelity").exists()
    again = sweep(known_study, many)
    assert (again.computed, again.run.place) == (0, first.folder)
    assert (first.folder / "figures" / "means.csv").read_bytes() == before
    assert (first.folder / "fidelity" / "fidelity.html").read_text() == "of many"
    assert json.loads((first.folder / "manifest.json").read_text())["blocks"]["each"] == spent
    assert names(own(few)) == [
        "config.yaml", "figures", "manifest.json", "order.csv", "plan.json", "summary.csv",
    ]  # fmt: skip


def test_an_interrupted_sweep_shows_no_table_of_another_question(study, faulty, config):
    many, few = config(**MANY), config(**FEW)
    sweep(study, many)
    with pytest.raises(KeyboardInterrupt):
        sweep(faulty(**{"A5.0": "interrupt"}), few)
    assert not list(run_folder(many).glob("*.csv"))
    assert (run_folder(many) / "config.yaml").read_text() == dump(few)
    assert levels(own(many)) == {1.0, 2.0, 0.3}


def test_two_sweeps_of_one_folder_do_not_mix_their_answers(study, config):
    many, few = config(**MANY), config(**FEW)

    class Meanwhile(Progress):
        def start(self, total, reused):
            sweep(study, few)

    slow = sweep(study, many, progress=Meanwhile()).run
    assert levels(run_folder(many)) == {5.0}
    assert levels(own(many)) == set(slow.summary()["level"]) == {1.0, 2.0, 0.3}
    assert slow.place == own(many)
    manifest = json.loads((run_folder(many) / "manifest.json").read_text())
    assert manifest["cases"]["computed"] == 2


def test_a_sweep_that_begins_while_another_writes_has_the_root(study, config, monkeypatch):
    """The one that writes has seen itself as the latest, just before."""
    many, few = config(**MANY), config(**FEW)
    write_all = asked.write_all

    def late(contents):
        if any(path.name == "summary.csv" for path in contents):
            monkeypatch.setattr(asked, "write_all", write_all)
            sweep(study, few)
        write_all(contents)

    monkeypatch.setattr(asked, "write_all", late)
    sweep(study, many)
    assert levels(run_folder(many)) == {5.0}
    assert levels(own(many)) == {1.0, 2.0, 0.3}


def test_figures_of_an_earlier_question_stay_out_of_the_root(known_study, config, monkeypatch):
    many, few = config(**MANY), config(**FEW)
    run = sweep(known_study, many).run
    show_figures = asked.show_figures
    files = []

    def late(*arguments):
        monkeypatch.setattr(asked, "show_figures", show_figures)
        sweep(known_study, few)  # it begins while the other's figures are drawn
        files.extend(show_figures(*arguments))
        return files

    monkeypatch.setattr(asked, "show_figures", late)
    assert run.draw() == [own(many) / "figures" / "means.csv"] == files
    assert not (run.folder / "figures").exists()


def test_a_sweep_killed_while_it_takes_the_root_leaves_the_earlier_question(
    known_study, config, monkeypatch
):
    many, few = config(**MANY), config(**FEW)
    sweep(known_study, many)

    def killed(*_):
        raise KeyboardInterrupt

    with monkeypatch.context() as patched:
        patched.setattr(asked, "_move_made", killed)
        with pytest.raises(KeyboardInterrupt):
            sweep(known_study, few)
    opened = load(run_folder(many))
    assert opened.config == many
    assert set(opened.summary()["level"]) == {1.0, 2.0, 0.3}
    sweep(known_study, few)
    assert levels(run_folder(many)) == {5.0}


def test_fresh_forgets_all_questions(study, config):
    many, few = config(**MANY), config(**FEW)
    run = sweep(study, many).run
    (run.folder / "asked" / "mine").mkdir()
    (run.folder / "notes.csv").write_text("the user's")
    sweep(study, few, fresh=True)
    assert sorted(names(run.folder / "asked")) == sorted(["mine", own(few).name, "latest"])
    assert (run.folder / "notes.csv").exists()


def test_a_full_disk_moves_nothing(study, config, monkeypatch):
    many, few = config(**MANY), config(**FEW)
    sweep(study, many)
    through = files._write_through

    def full(path, data):
        if "plan.json" in path.name:
            raise OSError(28, "No space left on device")
        through(path, data)

    monkeypatch.setattr(files, "_write_through", full)
    with pytest.raises(InputError, match=r"^results: .*No space left"):
        sweep(study, few)
    assert levels(run_folder(many)) == {1.0, 2.0, 0.3}
    assert (run_folder(many) / "config.yaml").read_text() == dump(many)


def test_a_link_in_place_of_the_questions_is_refused(study, config, tmp_path):
    many = config(**MANY)
    run_folder(many).mkdir(parents=True)
    (tmp_path / "elsewhere").mkdir()
    (run_folder(many) / "asked").symlink_to(tmp_path / "elsewhere")
    with pytest.raises(InputError, match="asked: this is a link where a folder belongs"):
        sweep(study, many)
    assert names(tmp_path / "elsewhere") == []


def test_show_lists_questions_and_runs_nothing_of_them(known_study, config, capsys):
    many, few = config(**MANY), config(**FEW)
    sweep(known_study, many)
    root = sweep(known_study, few).run.folder
    for number, text in enumerate(["a: &a [x]\nb: *a", "- 1", "schemes: {_target_: os.system}"]):
        folder = root / "asked" / f"{number:010}"
        folder.mkdir()
        (folder / "config.yaml").write_text(text)
    os.mkfifo(root / "asked" / "0000000000" / "manifest.json")
    capsys.readouterr()
    assert main(["show", str(root)]) == 0
    shown = capsys.readouterr().out
    lines = {line.split()[0]: line for line in shown[shown.index("\nasked:") :].split("\n")[2:-1]}
    assert lines[own(few).name].split()[1] == "*"
    assert lines[own(few).name].endswith("level (1), schemes A")
    assert lines[own(many).name].endswith("level (3), schemes A B")
    assert "an alias" in lines["0000000000"]
    assert "time unknown" in lines["0000000002"]


def test_what_is_asked_names_a_question_and_how_it_is_computed_does_not(config):
    c = config()
    assert question_hash(config(workers=2, name="x", results="elsewhere")) == question_hash(c)
    assert len({question_hash(config(**change)) for change in (MANY, FEW, {"seed": 1})}) == 3
    assert asked.find_home(own(c)) == run_folder(c)
    assert asked.find_home(run_folder(c)) is None


def test_a_run_is_told_in_one_line(study, config):
    run = sweep(study, config()).run
    assert repr(run) == f"<Run {run.folder}: study dummy, 12 cases>"
