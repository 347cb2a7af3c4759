"""Many tables as one: what pandas would make of them all at once, with text as codes."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pyarrow as pa
import pytest

from owtsweep.sweep import gather as module
from owtsweep.sweep.gather import as_text, gather, sort_rows


def table(**columns):
    return pa.Table.from_pandas(pd.DataFrame(columns), preserve_index=False)


WHOLE = table(s=["b", "a", ""], n=[1, 2, 3], x=[np.nan, 1.0, -0.0], f=[True, False, True])
OTHER = table(s=["é", "a"], n=[5, 6], x=[np.nan, 0.1], f=[False, False])
NO_FLAG = table(s=["z", "a"], n=[1, 2], x=[np.nan, 1.0])
NO_TEXT = table(n=[4], x=[1.0], f=[True])
EMPTY_TEXT = table(s=pd.Series([None], dtype="str"), n=[4], x=[1.0], f=[True])
UNTYPED = table(s=pd.Series([None], dtype="object"), n=[4], x=[1.0], f=[True])


@pytest.mark.parametrize("batch", [1, 2, 256])
@pytest.mark.parametrize(
    "tables",
    [
        [WHOLE, OTHER, WHOLE],
        [WHOLE, NO_FLAG],
        [NO_TEXT, NO_TEXT, WHOLE],
        [WHOLE, EMPTY_TEXT, UNTYPED, OTHER],
        [UNTYPED, UNTYPED, WHOLE],
    ],
)
def test_gathered_rows_are_those_of_one_conversion(tables, batch, monkeypatch):
    monkeypatch.setattr(module, "BATCH", batch)
    whole = pa.concat_tables(tables, promote_options="default").to_pandas()
    found = gather(iter(tables))
    assert isinstance(found["s"].dtype, pd.CategoricalDtype)
    assert list(found["s"].cat.categories) == sorted(set(whole["s"].dropna()))
    pd.testing.assert_frame_equal(as_text(found), whole, check_exact=True)


def test_nothing_gathered_is_none():
    assert gather([]) is None


def test_rows_are_sorted_as_pandas_sorts_their_text():
    random = np.random.default_rng(2)
    tables = [
        table(
            s=random.choice(["b", "", "Z", "a", "é"], 50),
            x=random.choice([np.nan, 1.0, 0.5], 50),
            i=np.arange(50) + 50 * number,
        )
        for number in range(3)
    ]
    whole = pa.concat_tables(tables).to_pandas()
    expected = whole.sort_values(["s", "x"], kind="stable", ignore_index=True)
    found = sort_rows(gather(tables), ["s", "x"])
    pd.testing.assert_frame_equal(as_text(found), expected, check_exact=True)
