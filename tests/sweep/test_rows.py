"""Rows that no table could be made of are refused before they are stored."""

from __future__ import annotations

from typing import Any

import pandas as pd
import pytest

from owtsweep.sweep.rows import WrongRows, needed_columns
from owtsweep.sweep.run import sweep
from owtsweep.sweep.store import encode


@pytest.fixture
def rows(study: Any, config: Any) -> pd.DataFrame:
    (first, *_) = study.plan(config())
    ((_, frame),) = study.run(config(), [first])
    return frame


@pytest.mark.parametrize("column", ["status", "reason", "level", "scheme", "replicate"])
def test_a_missing_column_is_named(
    study: Any, config: Any, rows: pd.DataFrame, column: str
) -> None:
    needed = needed_columns(study, config())
    assert encode("key", rows, {}, needed)
    with pytest.raises(WrongRows, match=rf"^it has no column {column}$"):
        encode("key", rows.drop(columns=column), {}, needed)


def test_a_status_is_one_of_three(study: Any, config: Any, rows: pd.DataFrame) -> None:
    needed = needed_columns(study, config())
    with pytest.raises(WrongRows, match=r"^status 'OK' is none of ok, failed, unable$"):
        encode("key", rows.assign(status=["ok", "OK"]), {}, needed)
    with pytest.raises(WrongRows, match=r"^it has no rows$"):
        encode("key", rows.iloc[:0], {}, needed)


def test_rows_are_a_frame() -> None:
    with pytest.raises(TypeError, match=r"^the study's rows are a list, not a DataFrame$"):
        encode("key", [{"status": "ok"}], {})  # type: ignore[arg-type]


def test_refused_rows_are_not_stored(study: Any, config: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr(type(study), "sort_columns", lambda self: ["level", "shceme"])
    outcome = sweep(study, config())
    assert {failure.reason for failure in outcome.failed} == {"WrongRows: it has no column shceme"}
    assert not list(outcome.run.folder.glob("cases/*.parquet"))
    monkeypatch.undo()
    assert sweep(study, config()).failed == []
