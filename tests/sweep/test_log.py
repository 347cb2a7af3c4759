"""What workers log arrives in run.log with the block's label, from every backend."""

from __future__ import annotations

import logging

import pytest

from owtsweep.sweep import log
from owtsweep.sweep.log import MOST_RECORDS, collect_records, run_log
from owtsweep.sweep.run import sweep


@pytest.mark.parametrize(("backend", "workers"), [("threading", 1), ("threading", 2), ("loky", 2)])
def test_records_of_workers_arrive_with_their_block(faulty, config, backend, workers):
    c = config(backend=backend, workers=workers)
    outcome = sweep(faulty(**{"A2.0": "log"}), c)
    lines = (outcome.run.folder / "run.log").read_text().splitlines()
    told = [line.split(" ", 1)[1] for line in lines if "A2.0: " in line]
    assert told[0] == "INFO A2.0: at work"
    assert told[1] == "WARNING A2.0: a user's word"
    assert told[2].startswith("WARNING A2.0: ")
    assert "UserWarning: watch out" in told[2]
    assert len(told) == 3
    assert lines[-1].split(" ", 1)[1].startswith("INFO done: 12 computed")  # no label left behind


def test_a_chatty_task_is_cut(monkeypatch):
    logger = logging.getLogger("owtsweep.chatty")
    with collect_records(True) as records:
        for number in range(MOST_RECORDS + 7):
            logger.info("line %d", number)
    assert len(records) == MOST_RECORDS + 1
    assert records[-1].getMessage() == "7 more messages of this task were left out"


HOSTILE = "red \x1b[31m\n2026-01-01T00:00:00Z INFO done: \u202e"


@pytest.mark.parametrize("elsewhere", [False, True])
def test_every_line_is_printable_and_none_is_forged(tmp_path, elsewhere, monkeypatch):
    monkeypatch.setattr(logging.root, "handlers", [])  # those of pytest raise
    theirs = logging.getLogger("theirs")
    with run_log(tmp_path):
        with collect_records(elsewhere) as records:
            theirs.warning(HOSTILE)
            theirs.warning("%d", HOSTILE)  # its arguments do not fit: no fault of the sweep's
            try:
                raise ValueError(HOSTILE)
            except ValueError:
                theirs.exception("caught")
        if elsewhere:
            (tmp_path / "run.log").write_text("")
            log.repeat(records)
    lines = (tmp_path / "run.log").read_text().splitlines()
    assert all(line.isprintable() for line in lines)
    new = [line for line in lines if not line.startswith("  ")]
    assert [line.split()[1] for line in new] == ["WARNING", "WARNING", "ERROR"]
    assert new[0].endswith(r" red \x1b[31m")
    assert "cannot be formatted (TypeError: " in new[1]
    assert elsewhere or any(r"ValueError: red \x1b[31m" in line for line in lines)


def test_log_on_a_full_disk_is_silent(tmp_path, capsys, monkeypatch):
    def full(self):
        raise OSError(28, "No space left on device")

    with run_log(tmp_path):
        monkeypatch.setattr(log._Quiet, "flush", full)
        logging.getLogger("owtsweep").warning("lost")
    assert "No space" not in capsys.readouterr().err
