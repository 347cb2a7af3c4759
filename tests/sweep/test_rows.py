"""Rows that no table could be made of are refused before they are stored."""

from __future__ import annotations

from typing import Any

import pandas as pd
import pytest

from owtsweep.sweep.rows import require_rows
from owtsweep.sweep.run import sweep


@pytest.fixture
def rows(study: Any, config: Any) -> pd.DataFrame:
    (first, *_) = study.plan(config())
    ((_, frame),) = study.run(config(), [first])
    return frame


@pytest.mark.parametrize("column", ["status", "reason", "level", "scheme", "replicate"])
def test_a_missing_column_is_named(
    study: Any, config: Any, rows: pd.DataFrame, column: str
) -> None:
    require_rows(study, config(), rows)
    with pytest.raises(ValueError, match=rf"^the study's rows have no column {column}$"):
        require_rows(study, config(), rows.drop(columns=column))


def test_a_status_is_one_of_three(study: Any, config: Any, rows: pd.DataFrame) -> None:
    with pytest.raises(ValueError, match=r"^status 'OK' is none of ok, failed, unable$"):
        require_rows(study, config(), rows.assign(status=["ok", "OK"]))


def test_rows_are_a_frame(study: Any, config: Any) -> None:
    with pytest.raises(TypeError, match=r"^the study's rows are a list, not a DataFrame$"):
        require_rows(study, config(), [{"status": "ok"}])  # type: ignore[arg-type]


def test_refused_rows_are_not_stored(study: Any, config: Any, monkeypatch: Any) -> None:
    monkeypatch.setattr(type(study), "sort_columns", lambda self: ["level", "shceme"])
    outcome = sweep(study, config())
    assert {failure.reason for failure in outcome.failed} == {
        "ValueError: the study's rows have no column shceme"
    }
    assert not list(outcome.run.folder.glob("cases/*.parquet"))
    monkeypatch.undo()
    assert sweep(study, config()).failed == []
