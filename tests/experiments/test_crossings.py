"""Crossings of two schemes along a condition whose values were run one by one."""

import numpy as np
import pandas as pd

from experiments.tower.crossover import find_crossings

FACTORS = (0.5, 0.8, 1.0, 1.25, 2.0)


def make_rows(scatter: float, replicates: int = 8, factors=FACTORS) -> pd.DataFrame:
    """WHOLE has the error |log2 factor|, CUT .3; both share a replicate's own scatter."""
    random = np.random.default_rng(5)
    rows = []
    for noise in (1.0, 5.0):
        for replicate in range(replicates):
            shared, own = random.normal(size=2)
            for factor in factors:
                errors = {
                    "WHOLE": abs(np.log2(factor)) + shared + scatter * own,
                    "CUT": 0.3 + shared,
                }
                rows += [
                    {"noise": noise, "soil_factor": factor, "replicate": replicate, "value": value,
                     "scheme": scheme, "measure": "damage", "status": "ok"}
                    for scheme, value in errors.items()
                ]  # fmt: skip
    return pd.DataFrame(rows)


def find(rows: pd.DataFrame) -> pd.DataFrame:
    return find_crossings(rows, ("WHOLE", "CUT"), "damage")


def test_both_crossings_are_found_in_every_cell():
    found = find(make_rows(0.0))
    assert found["noise"].tolist() == [1.0, 1.0, 5.0, 5.0]
    # |log2 factor| is linear in the logarithm of the factor: interpolation is exact
    np.testing.assert_allclose(found["crossing"], [2.0**-0.3, 2.0**0.3] * 2, rtol=1e-12)
    assert found["better_above"].tolist() == ["WHOLE", "CUT"] * 2
    np.testing.assert_allclose(found["ci_low"], found["crossing"], rtol=1e-9)
    assert set(found["n"]) == {8}


def test_the_interval_holds_the_crossing_and_grows_with_scatter():
    narrow, wide = (find(make_rows(scatter)) for scatter in (0.02, 0.1))
    for found in (narrow, wide):
        assert (found["ci_low"] < found["crossing"]).all()
        assert (found["crossing"] < found["ci_high"]).all()
    assert (
        np.log(wide["ci_high"] / wide["ci_low"]) > np.log(narrow["ci_high"] / narrow["ci_low"])
    ).all()


def test_resamples_without_a_crossing_open_the_interval():
    found = find(make_rows(2.0, replicates=3))
    assert np.isinf(found["ci_high"]).any() or (found["ci_low"] == 0.0).any()


def test_no_crossing_no_row_and_one_record_no_interval():
    assert find(make_rows(0.0, factors=(1.5, 2.0))).empty
    assert find(make_rows(0.0, replicates=1))["ci_low"].isna().all()
