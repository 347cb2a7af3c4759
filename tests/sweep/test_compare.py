"""Finding runs, telling them apart and pairing them, with a study that has no physics."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import pandas as pd
import pytest
from dummy_study import DummyStudy, make_config

from owtsweep import studies
from owtsweep.api import load
from owtsweep.cli import main
from owtsweep.comparing.comparison import (
    FIRST,
    Comparison,
    Findings,
    Pair,
    flatten,
    make_pairs,
    rank_values,
    show,
    swept_keys,
)
from owtsweep.errors import InputError
from owtsweep.studies import registry
from owtsweep.sweep import compare as comparing
from owtsweep.sweep.run import sweep


@dataclass
class ComparableStudy(DummyStudy):
    """The dummy study, with a comparison: mean value per run."""

    commands = frozenset({"compare"})
    seen: list[Comparison] = field(default_factory=list)

    def compare(self, comparison: Comparison, folder: Path, *, metadata: Any) -> Findings:
        self.seen.append(comparison)
        means = [run.rows["value"].mean() for run in comparison.runs]
        table = pd.DataFrame({"run": [run.name for run in comparison.runs], "mean": means})
        overview = pd.DataFrame({"mean": [f"{mean:.3g}" for mean in means]})
        return Findings({"means": table}, overview, notes=(f"hashes {metadata['runs']}",))


@pytest.fixture
def comparable(monkeypatch):
    study = ComparableStudy()
    for module in (studies, registry):
        monkeypatch.setattr(module, "get_study", lambda name: study)
    return study


@pytest.fixture
def run(comparable, tmp_path):
    def run(results="results", faults=None, **changes):
        study = DummyStudy(faults or {})
        return str(sweep(study, make_config(tmp_path / results, **changes)).run.folder)

    return run


def compare(paths):
    return comparing.compare(paths, load)


def record(folder: Path, runs: list[dict[str, Any]]) -> None:
    (folder / "multirun.json").write_text(json.dumps({"runs": runs}))


def test_the_fewest_keys_that_tell_runs_apart_lead():
    configs = [
        {"tuning": t, "filter": {"q": q, "r": [q]}, "gnss": {"delay": d}, "results": str(q + d)}
        for t, q in (("a", 1), ("b", 2), ("c", 1))
        for d in (0.1, 0.2)
    ]
    assert swept_keys(configs) == (["tuning", "gnss.delay"], ["filter.q", "filter.r"])
    assert swept_keys(configs, ["gnss.delay"])[0] == ["gnss.delay", "tuning"]
    assert swept_keys(configs[:1]) == ([], [])
    assert swept_keys([{"grid": {"n": 1}, "name": "x"}, {"grid": {"n": 2}, "name": "y"}])[0] == []
    assert swept_keys([{"a": 1}, {"a": 1, "b": 2}])[0] == ["b"]


def test_small_helpers():
    assert flatten({"a": {"b": 1, "c": {}}, "d": [1, {"e": 2}]}) == {
        "a.b": 1, "a.c": {}, "d": [1, {"e": 2}],
    }  # fmt: skip
    assert rank_values([10.0, 2.0, 10.0]) == [1, 0, 1]
    assert rank_values(["b", "a", "b"]) == [0, 1, 0]
    assert rank_values([None, 1.0]) == [0, 1]
    assert [show(value) for value in (1.0, 0.1, "a", None, [1, 2], True)] == [
        "1", "0.1", "a", "null", "[1,2]", "true",
    ]  # fmt: skip


def test_pairs_are_neighbours_along_one_key_and_every_run_with_the_first():
    places = [(i, j) for i in range(3) for j in range(3)]
    pairs = make_pairs(places, ["a", "b"])
    brute = []
    for x in range(9):
        for y in range(9):
            step = (places[y][0] - places[x][0], places[y][1] - places[x][1])
            if step in ((1, 0), (0, 1)):
                brute.append(Pair(x, y, "ab"[step.index(1)]))
    known = {(pair.first, pair.second) for pair in brute}
    brute += [Pair(0, y, FIRST) for y in range(1, 9) if (0, y) not in known]
    assert sorted(pairs, key=repr) == sorted(brute, key=repr)
    # a value that is missing does not end the line
    assert make_pairs([(0,), (2,)], ["a"]) == [Pair(0, 1, "a")]


def test_loose_runs_are_compared_beside_the_first(run, comparable):
    folders = [run(sigma=0.2), run(sigma=0.1)]
    compared = compare(folders)
    assert compared.folder.parent == Path(folders[0]).parent
    assert compared.folder.name.startswith("comparison-")
    assert compared.overview["sigma"].tolist() == ["0.1", "0.2"]  # numbers by size
    (comparison,) = comparable.seen
    assert comparison.pairs == (Pair(0, 1, "sigma"),)
    written = pd.read_csv(compared.folder / "means.csv")
    assert written["mean"][1] == pytest.approx(2.0 * written["mean"][0], rel=1e-12)
    report = (compared.folder / "comparison.md").read_text()
    assert "| sigma | mean | run folder |" in report
    assert all(candidate.hash in report for candidate in comparison.runs)
    assert compare(folders).folder == compared.folder


def test_a_multirun_is_compared_in_itself_and_names_what_is_missing(run, comparable, tmp_path):
    names = [Path(run(sigma=sigma)).name for sigma in (0.3, 0.1)]
    broken = run(sigma=0.2, faults={"A1.0": "cases"})
    blind = run(sigma=0.6, faults={"A1.0": "unable"})
    empty = run(sigma=0.4, level=[1.0], faults={"A1.0": "cases", "B1.0": "cases"})
    Path(run(sigma=0.5), "config.yaml").write_text("[")
    folder = tmp_path / "results"
    known = [{"folder": name, "values": {"sigma": ""}} for name in ["study-gone", *names]]
    record(folder, known)
    compared = compare([str(folder)])
    assert compared.folder == folder / "comparison"
    assert compared.overview["sigma"].tolist() == ["0.1", "0.2", "0.3", "0.6"]
    notes = "\n".join(compared.notes)
    assert "study-gone is left out: it was never started" in notes
    assert f"{Path(empty).name} is left out: no case of it has succeeded" in notes
    assert f"{Path(broken).name}: 2 of its 12 rows failed" in notes
    assert f"{Path(blind).name}: no number in 1 of its 12 rows" in notes
    assert "config.yaml" in notes
    before = {path.name for path in compared.folder.iterdir()}
    assert compare([str(folder)]).folder == compared.folder  # the comparison is no run
    assert {path.name for path in compared.folder.iterdir()} == before


def test_missing_blocks_are_named(run, tmp_path):
    one, other = run(sigma=0.1), run(sigma=0.2)
    next(Path(one, "cases").glob("*.parquet")).unlink()
    assert any("1 of its blocks are missing" in note for note in compare([one, other]).notes)


def test_runs_on_other_grids_are_told_apart_by_their_folders(run, comparable):
    folders = [run(name="b", level=[1.0]), run(name="a", level=[1.0, 2.0])]
    compare(folders)
    assert comparable.seen[0].keys == ("run",)
    assert [r.values["run"] for r in comparable.seen[0].runs] == ["b", "a"]


@pytest.mark.parametrize(
    ("words", "says"),
    [
        (["nowhere"], "nowhere"),
        (["file"], "file"),
        (["empty"], "no run in it"),
        (["results/one"], "only one run"),
        (["results/one", "results/one"], "twice"),
        (["failed"], "no case of it has succeeded"),
        ([], "RUN"),
    ],
)
def test_bad_input_is_one_line_and_writes_nothing(words, says, run, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    run(name="one")
    for sigma in (0.1, 0.2):
        run("failed", sigma=sigma, level=[1.0], faults={"A1.0": "cases", "B1.0": "cases"})
    Path("empty").mkdir()
    Path("file").write_text("")
    before = sorted(tmp_path.rglob("*"))
    assert main(["compare", *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    lines = [line for line in err.splitlines() if line.startswith("owtsweep: ")]
    assert says in lines[-1]
    assert sorted(tmp_path.rglob("*")) == before


def test_a_study_without_a_comparison_says_so(run, monkeypatch):
    folders = [run(sigma=0.1), run(sigma=0.2)]
    for module in (studies, registry):
        monkeypatch.setattr(module, "get_study", lambda name: DummyStudy())
    with pytest.raises(InputError, match="has no comparison"):
        compare(folders)


def test_runs_of_several_studies_are_refused(run):
    folders = [run(sigma=0.1), run(sigma=0.2, study="other")]
    with pytest.raises(InputError, match="several studies, dummy, other"):
        compare(folders)


def test_the_command_shows_a_plain_table_and_notes(run, capsys):
    assert main(["compare", run(sigma=0.1), run(sigma=0.2)]) == 0
    out, err = capsys.readouterr()
    assert out.splitlines()[0].split() == ["sigma", "mean"]
    assert "comparison.md" in out.splitlines()[-1]
    assert "note: hashes" in err


def test_the_command_shows_a_table_in_a_terminal(run, capsys, monkeypatch):
    monkeypatch.setattr("sys.stdout.isatty", lambda: True, raising=False)
    monkeypatch.setenv("COLUMNS", "15")  # just as much as it needs
    assert main(["compare", run(sigma=0.1), run(sigma=0.2)]) == 0
    lines = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [lines[0], lines[2][:1], lines[3][:1]] == [["sigma", "mean"], ["0.1"], ["0.2"]]


def test_names_are_told_in_printable_text(run, tmp_path, capsys):
    for number in (1, 2):  # alike but for their grids, so their folders tell them apart
        folder = run("many", name=f"run{number}", level=[1.0, 2.0][:number])
    Path(folder).rename(Path(folder).with_name("run\x1b[2J\u202e"))
    (tmp_path / "many" / "multirun.json").write_text(
        json.dumps({"runs": [{"folder": "\ud800\x1b[2J", "values": {"\ud800": "1"}}]})
    )
    assert main(["compare", str(tmp_path / "many")]) == 0
    out, err = capsys.readouterr()
    assert r"run\x1b[2J\u202e" in out
    assert r"note: \ud800\x1b[2J is left out" in err
    report = (tmp_path / "many" / "comparison" / "comparison.md").read_text()
    for line in (out + err + report).split("\n"):
        assert line.isprintable(), repr(line)
    assert show("a\x1b") == r"a\x1b"


def test_folders_whose_names_are_not_utf_8_are_compared(run, capsys):
    first, second = run(name="one"), run(name="two", level=[1.0])
    Path(first).rename(Path(first).with_name("on\udcff"))
    assert main(["compare", str(Path(first).with_name("on\udcff")), second]) == 0
    out = capsys.readouterr().out
    assert r"on\udcff" in out
    assert out.isascii()


@pytest.mark.parametrize(
    ("answer", "says"),
    [
        (lambda: {}["soil"], r"KeyError: 'soil'"),
        (lambda: None, r"AttributeError: 'NoneType' object has no attribute"),
        (lambda: Findings({"means": [1]}, pd.DataFrame()), r"AttributeError: 'list' object has no"),
    ],
)
def test_a_study_of_another_package_that_cannot_compare_is_named(
    run, monkeypatch, capsys, tmp_path, answer, says
):
    monkeypatch.setattr("importlib.metadata.packages_distributions", dict)  # takes a second
    monkeypatch.setattr(ComparableStudy, "compare", lambda *args, **options: answer())
    folders = [run(sigma=0.1), run(sigma=0.2)]
    before = sorted(tmp_path.rglob("*"))
    assert main(["compare", *folders]) == 2
    err = capsys.readouterr().err
    assert err.startswith(
        f"owtsweep: study: 'dummy' of the package test_compare does not work ({says}"
    )
    assert err.count("\n") == 1
    assert sorted(tmp_path.rglob("*")) == before
