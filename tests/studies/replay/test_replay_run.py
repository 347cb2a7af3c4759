"""A replay as a run: outputs, resume, grids of records, the command line, bad input."""

from __future__ import annotations

import io
import os
import re
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from replay_tools import motion_file, sensor_file
from rich.console import Console

import owtsweep
from owtsweep.cli import main
from owtsweep.studies.hub.public import tell_window
from owtsweep.studies.replay import facts
from owtsweep.studies.replay.measures import BASELINE_ROWS
from owtsweep.studies.replay.report import render_answer
from owtsweep.studies.replay.running import configure, execute, expand
from owtsweep.sweep.keys import run_folder, run_hash
from owtsweep.sweep.runs import Run

QUICK = ["schemes=[MKF,HME1]", "replay.replicates=2", "measures.settling_time=5", "tuning=matched"]


@pytest.fixture(autouse=True)
def _in_a_folder_of_its_own(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)


def test_outputs(capsys):
    motion_file(Path("tower.csv"), mean=(1.5, 0.0), duration=30.0)
    assert main(["replay", "tower.csv", *QUICK]) == 0
    out, err = capsys.readouterr()
    assert "HME1" in out
    assert "by the expected map at its period and amplitude" in " ".join(out.split())
    assert tell_window("settled", 5.0) in " ".join(out.split())
    alone = "The advice is for this motion of tower.csv alone, with noise drawn anew."
    assert alone in " ".join(out.split())
    assert "note: motion kept up to 5 Hz" in err
    (run,) = Path("results").iterdir()
    assert run.name.startswith("replay-tower-")
    assert out.splitlines()[0].endswith(f"{run.resolve().name}/report.md")
    best, second, nothing = out.splitlines()[-3:]
    assert best.startswith("HME1 is best: error 0.0")
    assert second.startswith("Runner-up: MKF, 0.0")
    assert nothing.startswith("No estimator (best baseline ")
    replayed = pd.read_csv(run / "replay.csv")
    assert list(replayed.columns) == ["scheme", "measure", "window", "value"]
    keys = replayed.set_index(["scheme", "measure", "window"])["value"]
    assert not keys.index.duplicated().any()
    assert 0.8 < keys["HME1", "coverage_position", "settled"] <= 1.0
    assert keys["last_fix", "position", "settled"] > keys["HME1", "position", "settled"]
    estimates = pd.read_parquet(run / "estimates.parquet")
    assert list(estimates.columns) == [
        "time", "scheme", "x", "y", "vx", "vy", "x_std", "y_std", "vx_std", "vy_std",
    ]  # fmt: skip
    assert set(estimates.scheme) == {"MKF", "HME1"}
    own = estimates[estimates.scheme == "HME1"]
    assert own.x.to_numpy()[1000:].mean() == pytest.approx(1.5, abs=0.05)  # in the file's frame
    truth = pd.read_csv("tower.csv")
    late = own[own.time > 10]
    apart = late.x - np.interp(late.time, truth.time, truth.position_x)
    assert np.sqrt(np.mean(apart**2)) < 0.1
    one = pd.read_csv(run / "estimates" / "HME1.csv")
    assert np.array_equal(one.x, own.x)
    report = (run / "report.md").read_text()
    assert f"- {alone}" in report
    assert f"- {tell_window('settled', 5.0)}" in report
    for link in ("position_zoom", "velocity_zoom", "spectrum", "place_in_map", "bias"):
        assert f"](figures/{link}.png)" in report
        assert (run / f"figures/{link}.png").stat().st_size > 10_000
        assert (run / f"figures/{link}.svg").stat().st_size < 500 * 1024
    assert len(owtsweep.load(run).draw("spectrum")) == 2
    assert main(["show", str(run)]) == 0


def test_python_interface():
    motion_file(Path("a.csv"), duration=30.0)
    replay = owtsweep.replay("a.csv", QUICK)
    assert set(replay.errors().scheme) == {"MKF", "HME1", *BASELINE_ROWS}
    assert list(replay.advice().source) == ["record", "map"]
    assert replay.records().loc[0, "natural_period"] > 0.0
    assert set(replay.estimates().scheme) == {"MKF", "HME1"}
    console = Console(width=80, file=io.StringIO(), color_system=None)
    console.print(render_answer(replay.run.config, replay.run.tables()))
    shown = console.file.getvalue()
    assert {"position", "velocity", "±1.96", "innov.", "white"} <= set(shown.split())
    assert "…" not in shown  # rich's mark where it has cut a text
    assert owtsweep.load(replay.folder).table("replay").equals(replay.run.table("replay"))
    with pytest.raises(owtsweep.InputError, match="none of a"):
        replay.estimates("b")


def test_many_records_resume_and_equal_single_ones():
    words = [*QUICK[1:], "schemes=[MKF]"]
    for number in range(3):
        motion_file(Path(f"r{number}.csv"), duration=25.0, rms=0.1 * (1 + number), seed=number)
    first = execute(configure(["r0.csv", "r1.csv"], words))
    assert (first.computed, first.reused) == (4, 0)
    both = execute(configure(["r[0-9].csv"], words))
    assert (both.computed, both.reused) == (2, 4)
    assert both.run.folder == first.run.folder
    scratch = execute(configure(["r2.csv", "r1.csv", "r0.csv"], [*words, "name=scratch"]))
    key = ["file", "scheme", "measure", "window"]
    one, other = (
        o.run.table("errors").sort_values(key, ignore_index=True) for o in (both, scratch)
    )
    pd.testing.assert_frame_equal(one, other, check_exact=True)
    alone = owtsweep.replay("r1.csv", words).errors().drop(columns="file")
    among = one[one.file == "r1"].drop(columns="file")
    pd.testing.assert_frame_equal(
        alone.sort_values(key[1:], ignore_index=True),
        among.sort_values(key[1:], ignore_index=True),
        check_exact=True,
    )
    motion_file(Path("r1.csv"), duration=25.0, rms=0.7, seed=9)  # another record, the same name
    changed = execute(configure(["r0.csv", "r1.csv", "r2.csv"], words))
    assert (changed.computed, changed.reused) == (2, 4)


def test_records_of_one_name_do_not_share_a_folder():
    for number, folder in enumerate("ab"):
        Path(folder).mkdir()
        motion_file(Path(folder, "r.csv"), duration=20.0, seed=number)
    a, b = (configure([f"{folder}/r.csv"], [*QUICK, "schemes=[MKF]"]) for folder in "ab")
    assert run_folder(a) != run_folder(b)
    assert run_hash(a) == run_hash(b)  # of the settings
    assert re.fullmatch(rf"replay-r-[0-9a-f]{{8}}-{run_hash(a)}", run_folder(a).name)


def test_a_table_of_sea_states_becomes_a_map(capsys):
    lines = ["file,Hs,Tp"]
    for number, (height, period) in enumerate([(1, 6), (2, 6), (1, 8), (2, 8)]):
        motion_file(Path(f"s{number}.csv"), duration=25.0, rms=0.2 * height, period=period / 2)
        lines.append(f"s{number}.csv,{height},{period}")
    Path("seastates.csv").write_text("\n".join(lines) + "\n")
    assert main(["replay", "replay.table=seastates.csv", *QUICK]) == 0
    (run,) = Path("results").iterdir()
    records = pd.read_csv(run / "records.csv")
    assert list(records.columns[:3]) == ["file", "Hs", "Tp"]
    assert list(records.Hs) == [1, 2, 1, 2]
    assert (run / "figures/best_scheme_by_record.png").is_file()
    assert next(iter(pd.read_csv(run / "replay.csv"))) == "file"
    assert (run / "records/s3/estimates.parquet").is_file()
    assert "s2: by this record's own errors" in capsys.readouterr().out


def test_sensors_without_a_reference(capsys):
    sensor_file(Path("s.csv"), duration=40.0, reference=False, missing=(12, 13), jitter=0.03)
    assert main(["replay", "s.csv", *QUICK[1:], "schemes=[MKF]"]) == 0
    out, err = capsys.readouterr()
    assert "irregular by up to 0.0" in err
    assert "2 of" in err
    assert "distance from the fixes that came later" in out
    (run,) = Path("results").iterdir()
    measures = set(pd.read_csv(run / "replay.csv").measure)
    assert {"nis", "innovation_white_p", "fix_residual"} <= measures
    assert "position" not in measures


def test_fixes_without_delay_get_an_answer(capsys, monkeypatch):
    """The stated delay is 0.2 s; the record shows none, and is answered with what it shows."""
    monkeypatch.setattr(Run, "draw", lambda *args, **options: [])
    noise = np.random.default_rng(4).standard_normal((4, 4000))
    time = 0.02 * np.arange(4000)
    x, fixed = 0.3 * np.sin(1.2 * time), np.arange(4000) % 10 == 0
    record = pd.DataFrame({"time": time, "ax": -1.44 * x + 0.01 * noise[0], "ay": 0.01 * noise[1]})
    record["gps_x"] = np.where(fixed, x + 0.02 * noise[2], np.nan)
    record["gps_y"] = np.where(fixed, 0.02 * noise[3], np.nan)
    record.to_csv("s.csv", index=False)
    assert main(["replay", "s.csv", "schemes=[MKF]"]) == 0
    out, _ = capsys.readouterr()
    assert "in whole IMU steps: sensors.gnss.delay=0" in " ".join(out.split())
    assert "Run with the noise that the record shows" in out
    # a delay that suits the file's own rate, not the stated one of 100 Hz
    assert main(["replay", "s.csv", "schemes=[MKF]", "sensors.gnss.delay=0.01"]) == 2
    assert "the IMU step 0.02 s; use 0 or 0.02" in capsys.readouterr().err


BAD = {
    "no file": (["nothing.csv"], "there is no such file"),
    "no match": (["nothing*.csv"], "nothing matches"),
    "no word": ([], "name a record"),
    "a folder": (["."], "is a folder"),
    "empty": (["empty.csv"], "empty.csv"),
    "not FAST": (["broken.outb"], "broken.outb"),
    "unknown channel": (["good.csv", "columns.position_x=Nonsense"], "position_x"),
    "unknown key": (["good.csv", "replay.gns=auto"], "did you mean replay.gnss"),
    "unknown role": (["good.csv", "columns.position_z=a"], "columns.position_z"),
    "wrong unit": (["good.csv", "units.position_x=deg"], "deg"),
    "backwards": (["backwards.csv"], "goes backwards"),
    "two bad of two": (["backwards.csv", "gravity.csv"], "none of the 2 records can be used"),
    "gravity": (["gravity.csv"], "9.81"),
    "no table": (["good.csv", "replay.table=nothing.csv"], "replay.table"),
    "a choice": (["good.csv", "replay.input=guess"], "replay.input"),
    "an engine": (["good.csv", "engine=expected"], "engine"),
    "gaps": (["good.csv", "gaps=ignore"], "gaps"),
    "another band": (["good.csv", "replay.band=[20,30]"], "kept up to 5 Hz"),
    "hours": (["good.csv", "units.time=h", "sensors.imu.rate=50"], "units.time"),
    "a cut-off": (["good.csv", "replay.cutoff=9"], "replay.cutoff: 9 Hz"),
    "fixes of a motion": (["good.csv", "replay.gnss=recorded"], "replay.gnss=recorded"),
    "another study": (["good.csv", "study=hub"], "study: 'hub' replays no record"),
    "a key of a section": (["good.csv", "replay.foo=1"], "there are replay.input"),
    "describe a key": (["good.csv", "--describe", "foo=1"], "foo"),
    "describe a channel": (["good.csv", "--describe", "columns.position_x=no"], "no channel 'no'"),
    "describe a unit": (["good.csv", "--describe", "units.position_x=g"], "units.position_x: 'g'"),
    "another table": (["good.csv", "replay.table=other.csv"], "names none of the records"),
    "a row without file": (["replay.table=blank.csv"], "row 2 names no file"),
    "a band": (["good.csv", "replay.band=[0.4,0.2]"], "replay.band"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_one_line_and_writes_nothing(case, capsys):
    motion_file(Path("good.csv"), duration=30.0)
    Path("empty.csv").write_text("")
    Path("other.csv").write_text("file,Hs\nempty.csv,1\n")
    Path("blank.csv").write_text("file,Hs\ngood.csv,1\n,2\n")
    Path("broken.outb").write_bytes(b"\x02\x00not a FAST file")
    times = [*range(40), 12, *range(41, 60)]
    Path("backwards.csv").write_text(
        "time,position_x\n" + "\n".join(f"{0.1 * t},{0.01 * t}" for t in times)
    )
    steps = range(4000)
    Path("gravity.csv").write_text(
        "time,specific_force_x,fix_x\n" + "\n".join(f"{0.01 * t},9.81,0.1" for t in steps)
    )
    before = sorted(Path().rglob("*"))
    words, message = BAD[case]
    assert main(["replay", *words]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.strip().splitlines()) == 1
    assert err.startswith("owtsweep: ")
    assert message in err
    assert sorted(Path().rglob("*")) == before


def test_describe_and_cfg(capsys):
    motion_file(Path("good.csv"), duration=30.0)
    assert main(["replay", "good.csv", "--describe"]) == 0
    assert "position_x" in capsys.readouterr().out
    words = ["columns.position_x=position_y", "units.position_x=mm"]
    assert main(["replay", "good.csv", "--describe", *words]) == 0
    assert "position_x        = position_y  mm," in capsys.readouterr().out
    assert main(["replay", "--cfg", "replay.replicates=3"]) == 0  # the keys, without any record
    assert "replicates: 3" in capsys.readouterr().out
    assert main(["replay", "--cfg", "good.csv", "columns.position_x=position_y"]) == 0
    assert "position_x: position_y" in capsys.readouterr().out
    assert not Path("results").exists()


def test_files_and_patterns():
    for name in ("b.csv", "a.csv", "a[1].csv"):
        Path(name).write_text("x")
    found = [Path(file).name for file in expand(["b.csv", "*.csv", "a[1].csv"])]
    assert found == ["b.csv", "a.csv", "a[1].csv"]


@pytest.mark.parametrize(
    ("name", "content"),
    [
        ("estimates", "file"), ("estimates", "pipe"),
        ("estimates.parquet", "folder"), ("estimates/MKF.csv", "folder"), ("report.md", "folder"),
        pytest.param("figures", "file", marks=pytest.mark.faults),
    ],
)  # fmt: skip
def test_what_cannot_be_written_is_told_and_no_case_is_lost(name, content, capsys, monkeypatch):
    if name != "figures":  # drawing takes most of the time
        monkeypatch.setattr(Run, "draw", lambda *args, **options: [])
    motion_file(Path("a.csv"), duration=25.0)
    path = Path("results/r", name)
    path.parent.mkdir(parents=True)
    {"file": path.touch, "folder": path.mkdir, "pipe": lambda: os.mkfifo(path)}[content]()
    words = ["replay", "a.csv", *QUICK[1:], "schemes=[MKF]", "replay.replicates=1", "name=r"]
    assert main(words) == 1
    out, err = capsys.readouterr()
    (line,) = [line for line in err.splitlines() if line.startswith("failed: ")]
    assert f"results/r/{name}: cannot be written (" in line
    assert "tmp" not in line
    assert "cases computed" in out
    (path.rmdir if content == "folder" else path.unlink)()
    assert main(words) == 0
    assert "0 cases computed" in capsys.readouterr().out
    assert not list(Path("results/r").rglob("*.tmp"))


def test_the_baseline_hold_is_the_last_fix_and_describes_no_record():
    motion_file(Path("tower.csv"), duration=30.0)
    overrides = ["schemes=[MKF,HOLD]", "replay.replicates=2", "measures.settling_time=5"]
    replayed = owtsweep.replay("tower.csv", overrides)
    errors = replayed.errors().set_index(["scheme", "measure", "window"])["mean"]
    for window in ("full", "settled"):
        held = errors["HOLD", "position", window]
        assert held == pytest.approx(errors["last_fix", "position", window], rel=1e-9)
    assert not {"nees", "nis"} & set(errors["HOLD"].index.get_level_values("measure"))
    assert facts.choose_describer(replayed.run.config) == 0
    with pytest.raises(
        owtsweep.InputError, match=r"^baselines: a replay always judges NONE, HOLD and DELTA"
    ):
        owtsweep.replay("tower.csv", ["baselines=[NONE]"])
