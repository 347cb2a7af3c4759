"""The fidelity report of a run, its files, and what is refused."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from pathlib import Path
from types import SimpleNamespace

import pandas as pd
import pytest
from tools import configure

import owtsweep
import owtsweep.api
from experiments.ren2019 import fidelity
from owtsweep.cli import main
from owtsweep.studies.hub.study import HubStudy
from owtsweep.sweep.runs import Run
from owtsweep.verdicts.inference import MISSING


class Sources(HTMLParser):
    """Everything that an HTML file would load, and whether its tags close."""

    def __init__(self) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.open: list[str] = []
        self.text: list[str] = []

    def handle_starttag(self, tag, attributes):
        self.loaded += [value for name, value in attributes if name in ("src", "href")]
        if tag not in ("img", "meta", "link"):
            self.open.append(tag)

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.text.append(data)


SMALL = [
    "grid.natural_period=[4.0,8.0]", "grid.amplitude=[0.2,1.0]", "grid.replicates=3",
    "record.duration=40", "sensors.imu.rate=20", "measures.settling_time=5",
    "hme.smoother_window=5", "hme.mhe.horizon=4", "name=small", "experiment=study", "tuning=paper",
]  # fmt: skip


@pytest.fixture(scope="module")
def home(tmp_path_factory) -> Path:
    """A folder with the small run."""
    folder = tmp_path_factory.mktemp("fidelity")
    owtsweep.run([*SMALL, f"results={folder / 'results'}"])
    return folder


def test_the_script_writes_the_report(home, monkeypatch, capsys):
    monkeypatch.chdir(home)
    fidelity.main("results/small")
    out, err = capsys.readouterr()
    assert err == ""
    assert out == "12 files: results/small/fidelity/fidelity.html\n"
    folder = home / "results" / "small" / "fidelity"
    csv = {path.stem: pd.read_csv(path) for path in folder.glob("*.csv")}
    assert set(csv) == {"fidelity", "fidelity_numbers", "fidelity_claims", "consistency"}
    assert ",".join(csv["fidelity"].columns) == (
        "item,kind,published,reproduced,ci_low,ci_high,ratio,agrees,why"
    )
    assert ",".join(csv["fidelity_numbers"].columns) == (
        "table,natural_period,amplitude,scheme,measure,published,printed,reproduced,ci_low,ci_high,"
        "record_low,record_high,chance,ratio,log2,missed_by_factor_2,why"
    )
    assert ",".join(csv["consistency"].columns) == (
        "scheme,natural_period,amplitude,nees,nees_low,nees_high,nis,nis_low,nis_high,verdict"
    )
    counts = csv["fidelity"]["kind"].value_counts()
    assert counts.to_dict() == {
        "number": 64, "statement": 11, "summary": 8, "boundary": 4, "winner": 4,
        "statement, x alone": 5, "boundary, x alone": 4,
    }  # fmt: skip
    agrees = csv["fidelity"].set_index("item")["agrees"]
    assert agrees["table 9 winner"] == agrees["table 9 EKF x"] == MISSING
    assert agrees["table 8 EKF x"] in ("yes", "no")

    markdown = (folder / "fidelity.md").read_text(encoding="utf-8")
    pictures = re.findall(r"!\[[^]]+\]\(([^)]+)\)", markdown)
    assert len(pictures) == 3
    assert all((folder / picture).is_file() for picture in pictures)
    assert "What this run lacks" in markdown
    assert "Table 9 EKF" in markdown.split("What this run lacks")[1]
    for line in (
        "## Statements", "### F11", "## F1 to F5 in x + y, and in x alone", "### Table 6",
        "## Boundary", "mainly the", "| EKF | vx | 1.98e-03 (misprinted as 1.98e-02) |",
    ):  # fmt: skip
        assert line in markdown

    html = Sources()
    page = (folder / "fidelity.html").read_text(encoding="utf-8")
    assert '<div class="wide words">' in page  # tables of sentences, which wrap
    html.feed(page)
    assert html.open == []
    assert len(html.loaded) == 4
    assert html.loaded[0] == "data:,"  # no icon is asked for
    assert all(source.startswith("data:image/png;base64,") for source in html.loaded[1:])
    assert "What this run lacks" in html.text


def test_the_command_judges_what_the_rows_of_a_run_can(home, monkeypatch, capsys):
    monkeypatch.chdir(home)
    assert main(["fidelity", "results/small"]) == 0
    told, files = capsys.readouterr().out.splitlines()
    assert told == (
        "not judged by the rows of a run: F9, F11; python -m experiments.ren2019.fidelity judges "
        "them"
    )
    assert files == "3 files: results/small/fidelity/fidelity.html"
    claims = pd.read_csv("results/small/fidelity/fidelity_claims.csv").set_index("statement")
    assert set(claims.index) == {f"F{number}" for number in range(1, 12)}
    assert claims.loc["F9", "missing"] == "scores of python -m experiments.ren2019.fidelity"
    assert claims.loc["F7", "missing"] == "3 s, 2 m"
    run = owtsweep.load("results/small")
    rows = run.summary().set_index(["scheme", "natural_period", "amplitude", "measure", "window"])
    means = [rows.loc[(name, 4.0, 0.2, "velocity", "full"), "mean"] for name in ("HME2", "HME1")]
    write_claims("mine.toml", "velocity", "select.natural_period = 4.0\nselect.amplitude = 0.2")
    assert main(["fidelity", "results/small", "--claims", "mine.toml"]) == 0
    (claim,) = pd.read_csv("results/small/fidelity/fidelity_claims.csv").to_dict("records")
    assert claim["value"] == pytest.approx(means[0] / means[1], rel=1e-9)
    assert "reproduces mine.toml" in Path("results/small/fidelity/fidelity.md").read_text()


def test_the_claims_of_the_docs_are_judged(home, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(home)
    page = (Path(__file__).parents[2] / "docs" / "claims.md").read_text("utf-8")
    (text,) = re.findall(r"```toml\n(.*?)```", page, flags=re.DOTALL)
    (tmp_path / "mine.toml").write_text(text, "utf-8")
    assert main(["fidelity", "results/small", "--claims", str(tmp_path / "mine.toml")]) == 0
    told = pd.read_csv("results/small/fidelity/fidelity_claims.csv")
    assert told["verdict"].tolist() == [MISSING, MISSING]  # the small run has other amplitudes
    assert told["comparisons"].tolist() == [0, 0]


def write_claims(file: str, measure: str, fields: str, head: str = "") -> None:
    Path(file).write_text(
        f'{head}\n[[statements]]\nname = "M1"\ntext = "t"\nprinted = "p"\ndefinition = "d"\n'
        f'[[statements.claims]]\ntext = "c"\nreason = "r"\nkind = "ratio_of_means"\n{fields}\n'
        f'select.measure = "{measure}"\nselect.scheme = "HME2"\nagainst = {{ scheme = "HME1" }}\n'
        'side = "below"\nbound = 1.0\n'
    )


@pytest.mark.parametrize(
    ("fields", "head", "told"),
    [
        ("select.sea = 1", "", "the rows of a run judge none of these statements"),
        ("", "", "natural_period has several values in these scores"),
        ("", 'study = "blade"', "its claims are about study 'blade'"),
        ("king = 1", "", "statement 1, claim 1: 'king' is not known; did you mean kind?"),
        (None, "", "there is no such file"),
    ],
)
def test_claims_that_cannot_be_judged_are_refused_in_one_line(
    home, tmp_path, monkeypatch, capsys, fields, head, told
):
    monkeypatch.chdir(tmp_path)
    if fields is not None:
        write_claims("mine.toml", "velocity", fields, head)
    assert main(["fidelity", str(home / "results" / "small"), "--claims", "mine.toml"]) == 2
    error = capsys.readouterr().err
    assert told in error
    assert error.count("\n") == 1


def test_other_folders_are_refused_in_one_line(tmp_path, monkeypatch, capsys):
    assert main(["fidelity", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "config.yaml" in error
    other = SimpleNamespace(folder=tmp_path, config=None, study=SimpleNamespace(name="mating"))
    monkeypatch.setattr(owtsweep.api, "load", lambda path: other)
    assert main(["fidelity", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "--claims: there are no claims about study 'mating' here" in error
    failed = pd.DataFrame({"status": ["failed"]})
    config = configure()
    broken = Run(tmp_path, config, HubStudy())
    monkeypatch.setattr(Run, "cases", lambda run: failed)
    monkeypatch.setattr(owtsweep.api, "load", lambda path: broken)
    assert main(["fidelity", str(tmp_path)]) == 2
    assert "no case of this run has succeeded" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
