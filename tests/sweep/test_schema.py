"""Shards that someone sealed with other rows: they count as missing, and nothing falls over."""

from __future__ import annotations

import logging
import os
import re
from collections.abc import Callable
from typing import Any

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest

from owtsweep.sweep import store
from owtsweep.sweep.rows import WrongRows
from owtsweep.sweep.run import sweep
from owtsweep.sweep.runs import Run
from owtsweep.sweep.study import Square

Change = Callable[[pd.DataFrame], pd.DataFrame]


def put(name: str, value: Any) -> Change:
    return lambda rows: rows.assign(**{name: [value] * len(rows)})


def reseal(run: Run, change: Change, monkeypatch: pytest.MonkeyPatch) -> None:
    """Seal other rows in place of those of the run's first block."""
    key = next(iter(run.plan()))
    path = run.store.path(key)
    rows = store.decode(path.read_bytes(), key, {}).to_pandas()
    with monkeypatch.context() as patch:
        patch.setattr(store, "check_columns", lambda *_: None)
        path.write_bytes(store.encode(key, change(rows), {"schema_version": "\x1b"}))


def repeat(rows: pd.DataFrame) -> pd.DataFrame:
    return rows.iloc[[0] * 100_000]


WRONG = {
    "no status": lambda rows: rows.drop(columns="status"),
    "no reason": lambda rows: rows.drop(columns="reason"),
    "no level": lambda rows: rows.drop(columns="level"),
    "no value": lambda rows: rows.drop(columns="value"),
    "no rows": lambda rows: rows.iloc[:0],
    "constants beyond measure": repeat,
    "text as value": put("value", "1.0"),
    "flags as value": put("value", True),
    "number as scheme": put("scheme", 3),
    "no scheme's name": put("scheme", None),
    "number as status": put("status", 1.0),
    "empty status": put("status", None),
    "status of its own": put("status", "great\x1b[2J"),
    "number as reason": put("reason", 2),
    "lists": put("extra", [1, 2]),
    "mappings": put("extra", {"a": 1}),
    "dates": put("extra", pd.Timestamp("2020-01-01")),
    "bytes": put("extra", b"\xff"),
    "square that no study makes": put("value", 1e-320),
    "square that no study makes, negative": put("value", -1e-301),
    "text where others have flags": put("flag", "yes"),
}


@pytest.fixture
def run(study: Any, config: Any, monkeypatch: pytest.MonkeyPatch) -> Run:
    types = {"scheme": str, "value": Square}
    monkeypatch.setattr(type(study), "row_types", types, raising=False)
    original = type(study).run

    def with_flag(self: Any, *words: Any) -> Any:
        return ((block, rows.assign(flag=True)) for block, rows in original(self, *words))

    monkeypatch.setattr(type(study), "run", with_flag)
    return sweep(study, config(level=[1.0, 2.0])).run


@pytest.mark.parametrize("kind", WRONG)
def test_rows_of_another_shape_count_as_missing(run, kind, monkeypatch, caplog):
    reseal(run, WRONG[kind], monkeypatch)
    if kind.startswith("text where"):  # what belongs there is known by the other shards alone
        monkeypatch.setattr(Run, "plan", lambda self: dict(reversed(run.stored_plan.items())))
    stored, missing = run.stored()
    rows = stored[""]
    assert missing == 1
    assert len(rows) == 6
    assert set(run.engine.tables(run.config, rows)) == {"order", "summary"}
    (record,) = caplog.records
    assert "holds no rows of this study" in record.message
    assert record.message.isprintable()
    assert not list(run.store.cases.glob("*.damaged"))  # it may be another version's


def test_a_sweep_computes_them_again(run, monkeypatch):
    before = run.cases()
    reseal(run, WRONG["no value"], monkeypatch)
    again = sweep(run.study, run.config)
    assert (again.computed, again.reused, again.failed) == (2, 6, [])
    pd.testing.assert_frame_equal(again.run.cases(), before)


def test_the_line_names_file_and_column(run, monkeypatch, caplog):
    reseal(run, put("value", 1e-320), monkeypatch)
    run.stored()
    assert re.search(r"part-\w+\.parquet holds .*: its column value holds 1e-320, ", caplog.text)


@pytest.mark.parametrize(
    "change",
    [
        *(put("value", value) for value in (7, 0.0, -1.0, 1e-299, None)),
        put("replicate", 0.5), put("more", 1), put("more", 1e-320),
    ],
)  # fmt: skip
def test_other_numbers_are_no_damage(run, change, monkeypatch):
    reseal(run, change, monkeypatch)
    stored, missing = run.stored()
    assert (len(stored[""]), missing) == (8, 0)


def test_whole_numbers_too_large_for_a_column_of_fractions_are_told(run, monkeypatch):
    reseal(run, put("value", 2**60 + 1), monkeypatch)
    with pytest.raises(ValueError, match="do not fit together"):
        run.stored()


def test_text_that_is_no_text_is_damage(run, monkeypatch, caplog):
    broken = pa.array([b"\xff\xfe"] * 2).view(pa.string())

    def change(rows: pd.DataFrame) -> pd.DataFrame:
        return rows.assign(scheme=pd.array(["xx"] * 2, dtype=pd.ArrowDtype(pa.string())))

    original = pa.table

    def table(columns: Any) -> Any:
        return original({**columns, "scheme": broken})

    with monkeypatch.context() as patch:
        patch.setattr(pa, "table", table)
        reseal(run, change, patch)
    assert run.stored()[1] == 1
    assert "UTF8" in caplog.records[-1].message


def test_a_study_cannot_store_what_could_not_be_read(study, config):
    rows = pd.DataFrame({"when": pd.to_datetime(["2020-01-01"])})
    with pytest.raises(WrongRows, match=r"column when holds timestamp\[.*\]; a column holds text"):
        store.encode("0" * 32, rows, {})


def test_the_reason_of_a_stranger_is_one_printable_line(run, monkeypatch):
    reseal(run, lambda rows: rows.assign(status="unable", reason="\x1b[2J\nno\u202e"), monkeypatch)
    (setback,) = run.unable()
    assert setback.reason == r"\x1b[2J\nno\u202e"


def test_a_shard_that_is_no_file_counts_as_missing(run, caplog):
    first, second, third, _ = (run.store.path(key) for key in run.plan())
    for path in (first, second, third):
        path.unlink()
    os.mkfifo(first)
    second.mkdir()
    third.symlink_to(third)
    assert run.stored()[1] == 3
    assert [r.levelno for r in caplog.records] == [logging.WARNING] * 3
    assert ["a pipe" in caplog.text, "a folder" in caplog.text] == [True, True]
    assert np.isfinite(run.cases()["value"]).all()
