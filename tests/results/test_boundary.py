"""The boundary of two schemes against a brute-force root, and what its intervals promise."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from scipy.optimize import brentq

from owtsweep.errors import InputError
from owtsweep.results import boundary as boundaries
from owtsweep.results.conditions import Condition
from owtsweep.studies.hub.worlds import CONDITIONS

PRODUCTS = ["motion", "cross", "noise"]


def boundary(rows: pd.DataFrame, lower: str = "HME2", window: str = "full") -> pd.DataFrame:
    schemes = lower, "HME1"
    difference = boundaries.subtract_schemes(rows, CONDITIONS, schemes, "position", window)
    return boundaries.find_boundary(difference, schemes)


def boundary_ratio(
    rows: pd.DataFrame, period_a: float, period_b: float
) -> tuple[float, float, float]:
    schemes = "HME2", "HME1"
    difference = boundaries.subtract_schemes(rows, CONDITIONS, schemes, "position", "full")
    products = boundaries.split_cells(difference)
    one, other = ((period,) for period in (period_a, period_b))
    return boundaries.divide_crossings((one, products[one]), (other, products[other]))


def run_rows(
    means: dict[tuple[str, float], tuple[float, float, float]],
    *,
    replicates: int = 12,
    spread: float = 0.2,
    seed: int = 1,
) -> pd.DataFrame:
    """Rows of superposed cases: (scheme, period) -> mean products, with common record effects."""
    rows = []
    for (scheme, period), products in means.items():
        for replicate in range(replicates):
            common = np.random.default_rng([seed, round(period * 10), replicate]).normal(size=3)
            own = np.random.default_rng(
                [seed, sum(scheme.encode()), round(period * 10), replicate]
            ).normal(size=3)
            factor = 1.0 + spread * (0.8 * common + 0.2 * own)
            cross = 1e-4 * own[1]
            motion, mean_cross, noise = products
            values = (motion * factor[0], mean_cross + cross, noise * factor[2])
            rows.append(
                {
                    "natural_period": period,
                    "replicate": replicate,
                    "scheme": scheme,
                    "measure": "position",
                    "window": "full",
                    "amplitude": np.nan,
                    **dict(zip(PRODUCTS, values, strict=True)),
                    "status": "ok",
                }
            )
    return pd.DataFrame(rows).sample(frac=1.0, random_state=3)


MEANS = {
    ("HME1", 4.0): (1e-3, 0.0, 4e-3),
    ("HME2", 4.0): (6e-3, 0.0, 3e-3),
    ("HME1", 8.0): (1e-3, -1e-4, 4e-3),
    ("HME2", 8.0): (2e-3, 2e-4, 3e-3),
}


def brute_force(rows: pd.DataFrame, period: float) -> float:
    """Where the mean MSE of HME2 begins to exceed HME1's."""
    table = rows[rows["natural_period"] == period].groupby("scheme")[PRODUCTS].mean()

    def excess(N: float) -> float:
        powers = np.array([N**2, 2 * N, 1.0])
        return float(table.loc["HME2"] @ powers - table.loc["HME1"] @ powers)

    return float(brentq(excess, 1e-6, 100.0, xtol=1e-14))


def test_boundary_is_the_root_of_the_mean_difference() -> None:
    rows = run_rows(MEANS)
    table = boundary(rows)
    assert table["natural_period"].tolist() == [4.0, 8.0]
    assert table["n"].tolist() == [12, 12]
    assert set(table["wins"]) == {""}
    for row in table.itertuples():
        assert row.boundary == pytest.approx(brute_force(rows, row.natural_period), rel=1e-9)
        assert row.ci_low < row.boundary < row.ci_high
    pd.testing.assert_frame_equal(table, boundary(rows.sample(frac=1.0, random_state=9)))


def test_the_interval_is_that_of_paired_records() -> None:
    """Against the delta method: the error of the root is that of the difference over its slope."""
    rows = run_rows(MEANS, replicates=200)
    row = boundary(rows).iloc[0]
    wide = rows[rows["natural_period"] == 4.0].pivot(index="replicate", columns="scheme")
    N = row.boundary
    powers = {"motion": N**2, "cross": 2 * N, "noise": 1.0}
    difference = sum(
        factor * (wide[name]["HME2"] - wide[name]["HME1"]) for name, factor in powers.items()
    )
    mean = {name: (wide[name]["HME2"] - wide[name]["HME1"]).mean() for name in PRODUCTS}
    slope = 2 * N * mean["motion"] + 2 * mean["cross"]
    error = difference.std() / np.sqrt(200) / slope
    assert row.ci_high - row.ci_low == pytest.approx(2 * 1.96 * error, rel=0.05)


@pytest.mark.parametrize("scheme", ["HME1", "HME2"])
def test_only_records_that_both_schemes_finished_count(scheme: str) -> None:
    rows = run_rows(MEANS)
    lost = (rows["scheme"] == scheme) & (rows["replicate"] < 4)
    failed = rows[lost].assign(status="failed", motion=1e3)
    kept = rows[rows["replicate"] >= 4]
    pd.testing.assert_frame_equal(boundary(pd.concat([rows[~lost], failed])), boundary(kept))
    assert boundary(kept)["n"].tolist() == [8, 8]


@pytest.mark.parametrize(
    ("lower", "upper", "wins"),
    [
        ((5e-3, 0.0, 5e-3), (1e-3, 0.0, 4e-3), "HME1"),
        ((1e-3, 0.0, 3e-3), (5e-3, 0.0, 4e-3), "HME2"),
        ((1e-3, 0.0, 5e-3), (5e-3, 0.0, 4e-3), "neither"),  # they change places the other way
        ((5e-3, -3e-3, 5e-3), (1e-3, 0.0, 4e-3), "neither"),  # better in between only
    ],
)
def test_without_a_boundary_the_winner_is_named(lower, upper, wins: str) -> None:
    rows = run_rows({("HME2", 4.0): lower, ("HME1", 4.0): upper}, spread=0.0)
    row = boundary(rows).iloc[0]
    assert np.isnan([row.boundary, row.ci_low, row.ci_high]).all()
    assert row.wins == wins


def test_an_interval_may_reach_zero_or_infinity() -> None:
    means = {("HME2", 4.0): (2e-3, 0.0, 3.7e-3), ("HME1", 4.0): (1e-3, 0.0, 4e-3)}
    row = boundary(run_rows(means, spread=0.4)).iloc[0]
    assert row.boundary > 0
    assert row.ci_low == 0.0
    means = {("HME2", 4.0): (1.02e-3, 0.0, 2e-3), ("HME1", 4.0): (1e-3, 0.0, 4e-3)}
    row = boundary(run_rows(means, spread=0.4)).iloc[0]
    assert 0 < row.ci_low < row.boundary < row.ci_high == np.inf


def test_one_record_has_no_interval() -> None:
    rows = run_rows(MEANS, replicates=1)
    assert boundary(rows)["boundary"].notna().all()
    assert boundary(rows)[["ci_low", "ci_high"]].isna().all(axis=None)
    ratio, low, high = boundary_ratio(rows, 8.0, 4.0)
    assert ratio > 0
    assert np.isnan([low, high]).all()


def test_ratio_of_two_boundaries() -> None:
    rows = run_rows(MEANS, replicates=100)
    ratio, low, high = boundary_ratio(rows, 8.0, 4.0)
    expected = brute_force(rows, 8.0) / brute_force(rows, 4.0)
    assert ratio == pytest.approx(expected, rel=1e-9)
    assert low < ratio < high
    assert boundary_ratio(rows, 4.0, 8.0) == pytest.approx((1 / ratio, 1 / high, 1 / low), rel=0.02)
    # independent records: relative errors add in squares
    widths = [
        np.log(row.ci_high / row.ci_low) for row in boundary(rows).itertuples() if row.boundary
    ]
    assert np.log(high / low) == pytest.approx(np.hypot(*widths), rel=0.15)
    nowhere = rows[rows["scheme"] == "HME2"].assign(scheme="HME1")
    both = pd.concat([rows[rows["scheme"] == "HME2"], nowhere.assign(noise=0.0, motion=0.0)])
    assert np.isnan(boundary_ratio(both, 8.0, 4.0)).all()


def test_refusals() -> None:
    rows = run_rows(MEANS)
    with pytest.raises(InputError, match=r"^lower: no superposed rows of scheme 'MKF'"):
        boundary(rows, "MKF")
    with pytest.raises(InputError, match=r"^lower: .* window 'settled'"):
        boundary(rows, window="settled")
    with pytest.raises(InputError, match=r"evaluation=superposed"):
        boundary(rows.assign(amplitude=1.0))


def test_a_boundary_over_other_conditions_or_over_none() -> None:
    gain = Condition("gain", "gain", scale="log", enters="scale")
    soil, heading = Condition("soil", "soil"), Condition("heading", "heading", "deg")
    rows = run_rows(MEANS).rename(columns={"natural_period": "heading", "amplitude": "gain"})
    both = pd.concat([rows.assign(soil="clay"), rows.assign(soil="sand", noise=2.0 * rows.noise)])
    schemes = "HME2", "HME1"
    told = schemes, "position", "full"
    difference = boundaries.subtract_schemes(both, (soil, heading, gain), *told)
    table = boundaries.find_boundary(difference, schemes)
    assert list(table.columns[:2]) == ["soil", "heading"]
    cells = table[["soil", "heading"]].to_records(index=False).tolist()
    assert cells == [("clay", 4.0), ("clay", 8.0), ("sand", 4.0), ("sand", 8.0)]
    expected = boundary(run_rows(MEANS))["boundary"]
    np.testing.assert_array_equal(table["boundary"][:2], expected)
    assert (table["boundary"][2:].to_numpy() > expected.to_numpy()).all()
    difference = boundaries.subtract_schemes(rows[rows.heading == 4.0], (gain,), *told)
    alone = boundaries.find_boundary(difference, schemes)
    assert list(alone.columns) == list(boundaries.COLUMNS)
    assert alone["boundary"][0] == pytest.approx(expected[0], rel=1e-12)
