"""The fidelity report of a run, its files, and what is refused."""

from __future__ import annotations

import re
from html.parser import HTMLParser
from types import SimpleNamespace

import pandas as pd
from tools import configure

import owtsweep
import owtsweep.api
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


def test_the_command_writes_the_report(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    small = [
        "grid.natural_period=[4.0,8.0]", "grid.amplitude=[0.2,1.0]", "grid.replicates=3",
        "record.duration=40", "sensors.imu.rate=20", "measures.settling_time=5",
        "hme.smoother_window=5", "hme.mhe.horizon=4", "name=small",
        "experiment=study", "tuning=paper",
    ]  # fmt: skip
    owtsweep.run(small)
    assert main(["fidelity", "results/small"]) == 0
    out, err = capsys.readouterr()
    assert err == ""
    assert out == "12 files: results/small/fidelity/fidelity.html\n"
    folder = tmp_path / "results" / "small" / "fidelity"
    csv = {path.stem: pd.read_csv(path) for path in folder.glob("*.csv")}
    assert set(csv) == {"fidelity", "fidelity_numbers", "fidelity_claims", "consistency"}
    assert ",".join(csv["fidelity"].columns) == (
        "item,kind,published,reproduced,ci_low,ci_high,ratio,agrees,why"
    )
    assert ",".join(csv["fidelity_numbers"].columns) == (
        "table,natural_period,amplitude,scheme,measure,published,printed,reproduced,ci_low,ci_high,"
        "record_low,record_high,quantile,ratio,log2,missed_by_factor_2,why"
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
    html.feed((folder / "fidelity.html").read_text(encoding="utf-8"))
    assert html.open == []
    assert len(html.loaded) == 3
    assert all(source.startswith("data:image/png;base64,") for source in html.loaded)
    assert "What this run lacks" in html.text


def test_other_folders_are_refused_in_one_line(tmp_path, monkeypatch, capsys):
    assert main(["fidelity", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "config.yaml" in error
    other = SimpleNamespace(folder=tmp_path, config=None, study=SimpleNamespace(name="blade"))
    monkeypatch.setattr(owtsweep.api, "load", lambda path: other)
    assert main(["fidelity", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1
    assert "study 'blade'" in error
    failed = pd.DataFrame({"status": ["failed"]})
    config = configure()
    broken = Run(tmp_path, config, HubStudy())
    monkeypatch.setattr(Run, "cases", lambda run: failed)
    monkeypatch.setattr(owtsweep.api, "load", lambda path: broken)
    assert main(["fidelity", str(tmp_path)]) == 2
    assert "no case of this run has succeeded" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
