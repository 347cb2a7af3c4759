"""Names of files and columns that a terminal, Markdown or TeX would obey; tables that clash."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
from replay_tools import config_of, motion_file

from owtsweep.cli import main
from owtsweep.errors import InputError
from owtsweep.studies.replay.files import hash_file, label_files, name_file
from owtsweep.studies.replay.report import tabulate_records
from owtsweep.studies.replay.running import LONGEST_EXPERIMENT, configure, expand, verify
from owtsweep.studies.replay.seastates import read_table

QUICK = ["schemes=[HME1]", "replay.replicates=1", "measures.settling_time=5"]
WILD = "n\x1b[31m|\n$\\frac{$ {x} %s [red] <b>.csv"


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


@pytest.mark.faults
def test_wild_names_are_replayed_and_reach_nothing_unescaped(capfd):
    motion_file(Path(WILD), duration=25.0)
    assert main(["replay", WILD, *QUICK]) == 0
    out, err = capfd.readouterr()
    assert "\x1b[31m" not in out + err
    assert "Warning" not in err
    (run,) = Path("results").iterdir()
    report = (run / "report.md").read_text()
    assert r"- n\\x1b\[31m|\\n\$\\frac{\$ {x} %s \[red\] \<b\>.csv: Recorded motion" in report
    assert len(list((run / "figures").glob("*.png"))) > 5


def test_labels_titles_and_names_of_runs():
    names = ["a/n\x1b|.csv", "b/\udce9.csv"]
    assert list(label_files(names)) == [r"n\x1b|", r"\udce9"]
    assert name_file("$\\frac{$\n") == r"$\frac{$\n"
    long = motion_file(Path("x" * 250 + ".csv"), duration=2.0)
    assert len(configure([str(long)], QUICK).experiment) == LONGEST_EXPERIMENT


def test_pipes_do_not_make_a_replay_wait():
    os.mkfifo("p.csv")
    os.mkfifo("p.sel")
    Path("p.dat").write_text("1 2\n")
    for act in (lambda: expand(["p.csv"]), lambda: hash_file("p.dat"), lambda: read_table("p.csv")):
        with pytest.raises(InputError, match="a pipe or a device"):
            act()
    with pytest.raises(InputError, match="there is no such file"):
        expand(["a" * 300])


def test_a_replay_takes_no_motion_but_that_of_the_record():
    with pytest.raises(InputError, match=r"motion from the record; leave out motion=plant"):
        config_of([], "motion=plant", "structure=ren2019")


def test_a_record_too_short_to_choose_a_spectrum_is_told():
    config = config_of([motion_file(Path("x.csv"), duration=25.0)], "schemes=[HME1,SKFA]")
    noted = [note for note in verify(config).notes if "choose a spectrum" in note]
    assert noted == ["SKFA had no time to choose a spectrum, which takes 30 s"]


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("file,duration,Hs\na.csv,1,2\n", "a column `duration` of its own"),
        ("file,a,Hs\na.csv,1,2\n", "a column `a` of its own"),
        ("file,file,Hs\na.csv,b.csv,2\n", "two columns `file`"),
        ("file,Hs\na.csv,inf\n", "column Hs, row 1: inf is beyond"),
        ("file,Hs\na.csv,1\nb.csv,-1e308\n", "column Hs, row 2"),
        ("file,Hs\na.csv,1\0\n", "binary data"),
        ("file,Hs\n" + "a.csv,1\n" * 1_300_000, "larger than 10 MB"),
    ],
)
def test_tables_that_are_refused(text, said):
    Path("t.csv").write_text(text)
    with pytest.raises(InputError, match=re.escape(said)) as caught:
        read_table("t.csv")
    assert str(caught.value).startswith("replay.table: t.csv: ")


def test_texts_of_a_table_are_made_printable():
    Path("t.csv").write_text('file,"$H\n|\x1b",site,Tp\na.csv,1,"<b>\n|",2\n')
    table = read_table("t.csv")
    assert list(table.columns) == ["file", r"$H\n|\x1b", "site", "Tp"]
    heading, _, row = tabulate_records(table).split("\n")
    assert r"$H\n\|\x1b" in heading
    assert r"&lt;b>\n\|" in row


@pytest.mark.faults
@pytest.mark.parametrize("band", ["[0.01,0.010001]", "[2.1,2.100001]"])
def test_band_without_a_line(band, capsys):
    motion_file(Path("a.csv"), duration=25.0)
    assert main(["replay", "a.csv", f"replay.band={band}", *QUICK]) == 0
    assert "holds 0 lines" in capsys.readouterr().err


@pytest.mark.parametrize(("band", "said"), [
    ("[1e-9,1e-8]", "at 1e-09 Hz, because to fixes at 1 Hz such a motion looks like a standstill"),
    ("[0.2,2]", "at 2 Hz, because to fixes at 1 Hz"),
    ("[0.2,60]", "60 Hz is not below 50 Hz, half of sensors.imu.rate"),
])  # fmt: skip
def test_a_band_without_expected_errors_is_refused_before_anything_runs(band, said, capsys):
    motion_file(Path("a.csv"), duration=25.0)
    assert main(["replay", "a.csv", f"replay.band={band}", *QUICK]) == 2
    error = capsys.readouterr().err
    assert error.startswith("owtsweep: replay.band: ")
    assert said in error
    assert error.count("\n") == 1
    assert not any(path.is_dir() for path in Path("results").glob("*"))
