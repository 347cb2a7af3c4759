"""A file system that refuses: at each write in turn, when it is full, and a really small one."""

from __future__ import annotations

import errno
import json
import logging
import os
import subprocess

import pytest
from fault_tools import content

from owtsweep import studies
from owtsweep.cli import running as command
from owtsweep.cli.program import main
from owtsweep.errors import InputError
from owtsweep.io import files
from owtsweep.sweep.keys import run_folder
from owtsweep.sweep.progress import Progress
from owtsweep.sweep.run import sweep

LEVELS = [1.0, 2.0, 3.0]


class Disk:
    """Writes through `owtsweep.io.files`, counted; from one on, or one alone, they fail."""

    def __init__(self, monkeypatch):
        self.writes, self.fail_at, self.onwards, self.number = [], None, False, errno.EIO
        self._through = files._write_through
        monkeypatch.setattr(files, "_write_through", self)

    def __call__(self, path, data):
        self.writes.append(path.name)
        count = len(self.writes)
        if self.fail_at and (count == self.fail_at or (self.onwards and count > self.fail_at)):
            path.write_bytes(data[: len(data) // 2])
            raise OSError(self.number, os.strerror(self.number))
        self._through(path, data)

    def fail(self, at, number, onwards):
        self.writes.clear()
        self.fail_at, self.number, self.onwards = at, number, onwards


@pytest.fixture
def disk(monkeypatch):
    return Disk(monkeypatch)


@pytest.mark.parametrize(
    ("number", "onwards"),
    [
        pytest.param(errno.EIO, False, marks=pytest.mark.faults, id="EIO once"),
        pytest.param(errno.EIO, True, marks=pytest.mark.faults, id="EIO from then on"),
        pytest.param(errno.ENOSPC, False, marks=pytest.mark.faults, id="full for a moment"),
        pytest.param(errno.ENOSPC, True, id="full"),
    ],
)
def test_error_at_each_write(study, config, disk, tmp_path, number, onwards):
    """Whichever write fails. All but the six shards and `latest` come twice, for root and question.

    In order: config.yaml and plan.json, between the two `latest`, manifest, six shards, two tables,
    manifest.
    """
    reference = content(sweep(study, config(results=tmp_path / "r", level=LEVELS)).run.folder)
    expected = len(disk.writes)
    assert expected == 19
    for at in range(1, expected + 1):
        c = config(results=tmp_path / f"{at}", level=LEVELS)
        disk.fail(at, number, onwards)
        if at <= 5:
            with pytest.raises(InputError, match=r"^results: .* cannot be written"):
                sweep(study, c)
        else:
            outcome = sweep(study, c)
            failed = sum(failure.cases for failure in outcome.failed)
            assert outcome.computed + failed == 12
            assert bool(outcome.failed) == (at < 18 and (at > 7 or onwards)), at
            now = content(outcome.run.folder)
            assert len([name for name in now if "part-" in name]) == outcome.computed // 2
            assert all(now[name] == reference[name] for name in now if "part-" in name)
            if number == errno.ENOSPC and 8 <= at <= 12:
                assert (
                    "not computed, because the disk is full"
                    in {failure.reason for failure in outcome.failed}
                    or at > 11
                )
        assert not list(run_folder(c).rglob(".*.tmp"))
        disk.fail(None, number, False)
        mended = sweep(study, c)
        assert mended.failed == []
        assert content(mended.run.folder) == reference


def test_tables_stay_as_they_were_if_one_does_not_fit(study, config, disk):
    before = content(sweep(study, config(level=LEVELS)).run.folder)
    disk.fail(9, errno.ENOSPC, False)  # config, plan, manifest twice, latest, one of two tables
    again = sweep(study, config(level=LEVELS))
    assert [failure.cases for failure in again.failed] == [0]
    assert "order.csv, summary.csv (left as they were)" in again.failed[0].label
    assert content(again.run.folder) == before


def test_tables_of_an_earlier_question_stay_if_those_of_the_next_do_not_fit(study, config, disk):
    first = sweep(study, config(level=LEVELS))
    before = first.run.summary()
    disk.fail(11, errno.ENOSPC, False)  # as above, and two more shards
    more = sweep(study, config(level=[*LEVELS, 4.0]))
    assert [failure.cases for failure in more.failed] == [0]
    assert not list(more.run.folder.glob("*.csv"))
    assert first.run.summary().equals(before)


def test_full_disk_is_told_in_plain_lines(study, config, disk, monkeypatch, capsys):
    monkeypatch.setattr(studies, "get_study", lambda name: study)
    # The command line's handler may be there from another test, with a stream long closed.
    monkeypatch.setattr(logging.getLogger("owtsweep"), "handlers", [])
    disk.fail(9, errno.ENOSPC, True)
    assert command.run_one(config(level=LEVELS), ["sweep", "--fresh", "--yes", "a=b c"]) == 1
    out, err = capsys.readouterr()
    lines = [line for line in err.splitlines() if line.startswith("failed: ")]
    assert len(lines) == 4  # two cases, the tables, the map, the page
    assert "OSError: [Errno 28] No space left on device" in err
    assert "not computed, because the disk is full: " in err
    assert err.splitlines()[-1].endswith("owtsweep sweep 'a=b c'")
    assert "Traceback" not in err
    assert out.splitlines()[-1].startswith("2 cases computed")


TINY = (
    "experiment=study", "tuning=paper", "grid.natural_period=[4.0]", "grid.amplitude=[1.0]",
    "grid.replicates=1", "record.duration=25", "schemes=[MKF]", "baselines=[]", "seed=1,2",
)  # fmt: skip


@pytest.mark.faults
@pytest.mark.parametrize(
    ("onwards", "code", "says"),
    [
        ("multirun.json", 2, "multirun.json: cannot be written (No space left on device); see to"),
        ("study-", 1, "its process ended without a word, or the disk is full; see its run.log"),
    ],
)
def test_a_multirun_on_a_full_disk_is_told_in_lines(
    onwards, code, says, tmp_path, monkeypatch, capsys
):
    """The disk is full from the first file of that name on: the record's, or an outcome's."""
    monkeypatch.chdir(tmp_path)
    through, full = files._write_through, []

    def write(path, data):
        if path.name.startswith(f".{onwards}"):
            full.append(path)
        if full:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        through(path, data)

    monkeypatch.setattr(files, "_write_through", write)
    assert main(["sweep", "-m", *TINY]) == code
    err = capsys.readouterr().err
    assert "Traceback" not in err
    assert "OSError" not in err
    assert says in err
    assert "Error executing job" not in err
    told = [line for line in err.splitlines() if line.startswith(("failed: ", "owtsweep: res"))]
    assert len(told) == (1 if code == 2 else 3)  # the whole multirun, or each run and the page


@pytest.mark.faults
def test_small_file_system(study, config, tmp_path):
    """A real disk of 256 KiB."""
    place = tmp_path / "small"
    place.mkdir()
    mount = ["mount", "-t", "tmpfs", "-o", "size=256k", "tmpfs", str(place)]
    if subprocess.run(mount, capture_output=True, check=False).returncode:
        pytest.skip("mounting a tmpfs is not allowed here")
    try:
        levels = [float(level) for level in range(1, 61)]
        c = config(results=place / "results", level=levels)
        outcome = sweep(study, c, progress=Progress())
        assert 0 < outcome.computed < 240
        assert outcome.computed + sum(failure.cases for failure in outcome.failed) == 240
        assert any("No space left" in failure.reason for failure in outcome.failed)
        subprocess.run(["mount", "-o", "remount,size=8m", str(place)], check=True)
        mended = sweep(study, c)
        assert (mended.failed, mended.reused) == ([], outcome.computed)
        assert json.loads((mended.run.folder / "manifest.json").read_text())["state"] == "done"
        whole = sweep(study, config(results=tmp_path / "r", level=levels))
        assert content(mended.run.folder) == content(whole.run.folder)
    finally:
        subprocess.run(["umount", str(place)], check=True)
