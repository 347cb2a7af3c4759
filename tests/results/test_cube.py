"""Rows that are no usable value of a case are left out of the cube, and it never grows wild."""

from __future__ import annotations

import math

import pandas as pd
import pytest
from hub_rows import superposed_rows, tabulate

from owtsweep.errors import InputError


@pytest.mark.parametrize(
    ("column", "value"),
    [
        ("natural_period", math.nan),
        ("natural_period", math.inf),
        ("measure", None),
        ("window", None),
        ("replicate", math.nan),
        ("motion", 1e300),
        ("cross", -1e300),
        ("noise", math.inf),
    ],
)
def test_a_row_without_a_label_or_a_usable_number_is_left_out(column, value):
    rows = superposed_rows(("MKF",), 3)
    changed = rows.astype({"replicate": float}) if column == "replicate" else rows.copy()
    changed.loc[0, column] = value
    pd.testing.assert_frame_equal(tabulate(changed), tabulate(rows.iloc[1:]), check_dtype=False)


def test_labels_that_do_not_fit_together_are_refused_before_memory_is_asked_for():
    rows = superposed_rows(("MKF",), 1).iloc[[0] * 3000].reset_index(drop=True)
    names = [f"m{number}" for number in range(3000)]
    rows = rows.assign(measure=names, window=names, replicate=range(3000))
    with pytest.raises(InputError, match=r"^rows: 3000 values for an array of 27000000000; "):
        tabulate(rows)
