"""The maps on the plant's seas: what the table says of small runs."""

from __future__ import annotations

import numpy as np
import pytest

import owtsweep
from experiments.ren2019.plant_map import DRAWN, MOTIONS, TUNINGS, draw, tabulate
from owtsweep.figures import style

SMALL = ("record.duration=60", "grid.replicates=2", "grid.amplitude=[0.1,5]")


@pytest.mark.usefixtures("kernels")
def test_each_cell_of_each_map_is_in_the_table_and_the_boundary_parts_them(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    words = [*SMALL, "grid.natural_period=[4,8]"]
    runs = {
        (motion, tuning): owtsweep.run([*truth, *words, *MOTIONS[motion]])
        for motion in DRAWN
        for tuning, truth in TUNINGS.items()
    }
    table = tabulate(runs)
    assert len(table) == len(runs) * 2 * 2
    for (motion, tuning), run in runs.items():
        cells = table[(table["motion"] == motion) & (table["tuning"] == tuning)]
        summary = run.summary().query("measure == 'position' and window == 'full'")
        schemes = summary[summary["scheme"].isin(["EKF", "MKF", "HME1", "HME2"])]
        mse = schemes.pivot(index=["natural_period", "amplitude"], columns="scheme", values="mean")
        found = cells.set_index(["natural_period", "amplitude"])
        np.testing.assert_allclose(found["mse_best"], mse.min(axis=1)[found.index])
        better = mse["HME2"] < mse["HME1"]
        with_one = found.dropna(subset="boundary")
        below = with_one.index.get_level_values("amplitude") < with_one["boundary"]
        assert (better[with_one.index] == below).all()
    assert table["mse_best"].nunique() > len(table) / 2  # the sea is another motion
    with style.context():
        assert len(draw(runs).axes) == 4
