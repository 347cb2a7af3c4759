"""Comparisons of real runs against scipy and plain pandas; contrasts against known truth."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image
from scipy import stats
from tools import SMALL

import owtsweep
from owtsweep.comparing.changes import changed_cells
from owtsweep.comparing.panels import arrange
from owtsweep.comparing.shift import boundary_shift
from owtsweep.errors import InputError
from owtsweep.results.boundary import boundary
from owtsweep.statistics.contrasts import difference, gap, ratio
from owtsweep.sweep.compare import Compared, compare
from owtsweep.sweep.comparison import Comparison, Pair

GRID = ["grid.natural_period=[4.0,8.0]", "grid.amplitude=[0.1,0.25,1.0]", "grid.replicates=5"]
WORDS = [*SMALL, *GRID, "schemes=[MKF,HME1,HME2]"]


@pytest.fixture(scope="module")
def folder(tmp_path_factory) -> Path:
    """Runs: two GNSS delays, another seed, and a smaller grid with one more scheme."""
    folder = tmp_path_factory.mktemp("runs")
    for name, words in {
        "early": ["sensors.gnss.delay=0.1"],
        "late": ["sensors.gnss.delay=0.5"],
        "seed": ["sensors.gnss.delay=0.5", "seed=7"],
        "small": ["sensors.gnss.delay=0.1", "grid.amplitude=[0.1,1.0]", "schemes=[EKF,MKF,HME1]"],
    }.items():
        owtsweep.run([*WORDS, *words, f"name={name}", f"results={folder}"])
    return folder


@pytest.fixture(scope="module")
def compared(folder) -> Compared:
    return compare([str(folder / "early"), str(folder / "late")])


def mse(folder: Path, scheme: str, period: float, amplitude: float) -> pd.Series:
    """Position MSE by replicate, from the cases and the formula alone."""
    rows = owtsweep.load(folder).cases()
    rows = rows[(rows.scheme == scheme) & (rows.natural_period == period)]
    rows = rows[(rows.measure == "position") & (rows.window == "full")].set_index("replicate")
    return amplitude**2 * rows.motion + 2 * amplitude * rows.cross + rows.noise


def test_scheme_changes_are_paired_differences_replicate_by_replicate(folder, compared):
    table = compared.findings.tables["scheme_changes"]
    assert len(table) == 3 * 6
    assert table.paired.all()
    for row in table.itertuples():
        cell = row.scheme, row.natural_period, row.amplitude
        before, after = mse(folder / "early", *cell), mse(folder / "late", *cell)
        interval = stats.ttest_rel(after, before).confidence_interval(0.95)
        assert row.difference == pytest.approx((after - before).mean(), rel=1e-9)
        assert (row.difference_low, row.difference_high) == pytest.approx(tuple(interval), rel=1e-6)
        assert row.ratio == pytest.approx(after.mean() / before.mean(), rel=1e-12)
        assert row.ratio_low < row.ratio < row.ratio_high
        assert row.n_from == row.n_to == 5


def test_another_seed_is_not_paired_and_gets_welchs_interval(folder):
    compared = compare([str(folder / "late"), str(folder / "seed")])
    assert any("seed differs" in note and "Welch" in note for note in compared.notes)
    table = compared.findings.tables["scheme_changes"]
    assert not table.paired.any()
    for row in table.itertuples():
        cell = row.scheme, row.natural_period, row.amplitude
        runs = [str(folder / ("seed" if "seed=7" in name else "late"))
                for name in (row.from_run, row.to_run)]  # fmt: skip
        before, after = (mse(Path(run), *cell) for run in runs)
        interval = stats.ttest_ind(after, before, equal_var=False).confidence_interval(0.95)
        assert (row.difference_low, row.difference_high) == pytest.approx(tuple(interval), rel=1e-6)


def test_changed_cells_are_those_whose_best_scheme_differs(folder, compared):
    best = [owtsweep.load(folder / name).best_scheme() for name in ("early", "late")]
    best = [own[own.criterion == "position"].reset_index(drop=True) for own in best]
    changed = compared.findings.tables["changed_cells"]
    differs = best[0].best != best[1].best
    assert differs.any()  # or this test says nothing
    cells = list(zip(changed.natural_period, changed.amplitude, strict=True))
    expected = best[0][differs]
    assert cells == list(zip(expected.natural_period, expected.amplitude, strict=True))
    for row in changed.itertuples():
        gaps = []
        for name in ("early", "late"):
            P, Q = (mse(folder / name, s, row.natural_period, row.amplitude)
                    for s in (row.best_from, row.best_to))  # fmt: skip
            gaps.append(Q - P)
        assert row.gap_from == pytest.approx(gaps[0].mean(), rel=1e-9)
        assert row.gap_to == pytest.approx(gaps[1].mean(), rel=1e-9)
        assert row.gap_from >= 0 >= row.gap_to
        interval = stats.ttest_1samp(gaps[1] - gaps[0], 0.0).confidence_interval(0.95)
        assert (row.change_low, row.change_high) == pytest.approx(tuple(interval), rel=1e-6)
    overview = compared.overview
    assert overview["cells changed"][1].startswith(f"{differs.sum()} (")
    for i, own in enumerate(best):
        for scheme in ("MKF", "HME1", "HME2"):
            assert int(overview[f"cells {scheme}"][i]) == (own.best == scheme).sum()


def test_boundaries_are_those_of_each_run(folder, compared):
    table = compared.findings.tables["boundaries"]
    for name in ("early", "late"):
        own = table[table.folder == name].reset_index(drop=True)
        expected = boundary(owtsweep.load(folder / name).cases())
        pd.testing.assert_frame_equal(own[list(expected.columns)], expected)


def test_other_grids_and_schemes_leave_the_common_cells(folder):
    compared = compare([str(folder / "late"), str(folder / "small")])
    notes = "\n".join(compared.notes)
    assert "grid.amplitude differs" in notes
    assert "left out: EKF, HME2" in notes
    assert "boundary" in notes
    table = compared.findings.tables["scheme_changes"]
    assert set(table.amplitude) == {0.1, 1.0}
    assert set(table.scheme) == {"MKF", "HME1"}


def test_runs_without_a_common_cell_or_criterion_are_refused(folder):
    other = ["sensors.gnss.delay=0.1", f"results={folder}", "schemes=[MKF]", "grid.replicates=1"]
    owtsweep.run([*WORDS, *other, "name=elsewhere", "grid.amplitude=[3.0]"])
    owtsweep.run([*WORDS, *other, "name=velocity", "measures.criterion=velocity"])
    before = set(folder.iterdir())
    for name, says in (("elsewhere", "grid.amplitude"), ("velocity", "criterion")):
        with pytest.raises(InputError, match=says):
            compare([str(folder / "late"), str(folder / name)])
    assert set(folder.iterdir()) == before


def test_expectations_are_compared_with_each_other_only(folder, tmp_path):
    runs = [
        owtsweep.run([*WORDS, "engine=expected", f"sensors.gnss.delay={d}", f"results={tmp_path}"])
        for d in (0.1, 0.5)
    ]
    folders = [str(run.folder) for run in runs]
    with pytest.raises(InputError, match=r"^engine: some runs are of engine=expected"):
        compare([folders[0], str(folder / "late")])
    found = compare(folders)
    assert any("no records" in note for note in found.notes)
    best = found.findings.tables["best_schemes"]
    for run in runs:
        own = run.best_scheme().query("criterion == 'position'").reset_index(drop=True)
        own = own.sort_values(["natural_period", "amplitude"], ignore_index=True)
        told = best[best.folder == run.folder.name][own.columns].reset_index(drop=True)
        pd.testing.assert_frame_equal(told, own, check_dtype=False)
        assert told.distinguishable.any()
    table = found.findings.tables["scheme_changes"]
    assert (table[["n_from", "n_to"]] == 0).all(axis=None)
    assert (table.verdict == "").all()
    means = [run.summary().query("measure == 'position' and window == 'full'") for run in runs]
    keys = ["scheme", "natural_period", "amplitude"]
    both = means[0].set_index(keys)["mean"], means[1].set_index(keys)["mean"]
    told = table.set_index(keys)
    np.testing.assert_allclose(told.ratio, (both[1] / both[0]).reindex(told.index), rtol=1e-12)


def test_figures_carry_the_hashes_of_the_runs(folder, compared):
    hashes = " ".join(owtsweep.load(folder / name).hash for name in ("early", "late"))
    assert compared.findings.figures
    for path in compared.findings.figures:
        if path.suffix == ".png":
            assert Image.open(path).info["runs"] == hashes
        else:
            assert json.dumps({"folder": compared.folder.name, "runs": hashes})[1:-1].replace(
                '"', "&quot;"
            ) in path.read_text().replace('"', "&quot;")


def samples(seed: int, n: int = 200_000) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of positive numbers with a common part, for many experiments of 8 replicates."""
    rng = np.random.default_rng(seed)
    common = rng.gamma(8.0, 1.0, size=(n // 8, 8))
    one = common + 0.5 * rng.gamma(4.0, 1.0, size=common.shape)
    other = 0.7 * common + rng.gamma(4.0, 1.0, size=common.shape)
    return one, other


@pytest.mark.parametrize("paired", [True, False])
def test_intervals_cover_the_truth_as_promised(paired):
    one, other = samples(1)
    if not paired:
        other = samples(2)[1]
    found, times = difference(one, other, paired=paired), ratio(one, other, paired=paired)
    truth = 0.7 * 8.0 + 4.0 - (8.0 + 2.0)
    cover = np.mean((found.low <= truth) & (truth <= found.high))
    assert 0.94 < cover < 0.965
    truth = (0.7 * 8.0 + 4.0) / 10.0
    assert 0.93 < np.mean((times.low <= truth) & (truth <= times.high)) < 0.965
    reference = (stats.ttest_rel if paired else stats.ttest_ind)(
        other[:9], one[:9], axis=-1, **({} if paired else {"equal_var": False})
    )
    np.testing.assert_allclose(found.p[:9], reference.pvalue, rtol=1e-9)


def test_pairing_counts_only_what_both_have_and_little_data_claims_nothing():
    one = np.array([[1.0, 2.0, np.nan, 4.0], [1.0, np.nan, np.nan, np.nan], [np.nan] * 4])
    other = np.array([[2.0, 4.0, 9.0, np.nan], [3.0, np.nan, 1.0, 1.0], [1.0] * 4])
    found = difference(one, other, paired=True)
    assert found.value[:2].tolist() == [1.5, 2.0]
    assert found.n_first.tolist() == [2, 1, 0]
    assert found.p[1:].tolist() == [1.0, 1.0]
    assert np.isnan(found.low[1:]).all()
    assert ratio(one, other, paired=True).value[0] == pytest.approx(2.0)
    thrice = ratio(one, 3.0 * one, paired=True)  # no noise is left in a ratio of equals
    assert (thrice.low[0], thrice.high[0]) == pytest.approx((3.0, 3.0), rel=1e-9)
    same = gap(np.array([[0.0, 0.0], [1.0, 1.0]]))
    assert same.p.tolist() == [1.0, 0.0]


def test_a_change_needs_both_gaps_and_holm_counts_every_cell():
    index = pd.MultiIndex.from_product([["P", "Q"], [1.0], [1.0, 2.0, 3.0]])
    noise = 1e-3 * np.arange(6.0)

    def table(gaps):  # Q less P in the three cells
        return pd.DataFrame([np.ones(6)] * 3 + [1.0 + g + noise - noise.mean() for g in gaps],
                            index=index)  # fmt: skip

    first, second = table([0.1, 0.1, 0.0003]), table([-0.1, 0.1, -0.1])
    best = {(1.0, N): "P" for N in (1.0, 2.0, 3.0)}
    after = {(1.0, 1.0): "Q", (1.0, 2.0): "P", (1.0, 3.0): "Q"}
    rows = changed_cells(first, second, best, after, paired=True)
    assert [row["amplitude"] for row in rows] == [1.0, 3.0]
    assert [row["established"] for row in rows] == [True, False]
    assert rows[0]["change"] == pytest.approx(-0.2)


def test_a_shifted_boundary_is_a_ratio_with_a_paired_interval(folder):
    rows = owtsweep.load(folder / "early").cases()
    scaled = rows.assign(motion=rows.motion / 4.0, cross=rows.cross / 2.0)  # twice the amplitude
    made = [fabricated(rows), fabricated(scaled)]
    args = (("HME2", "HME1"), "position", ("full", "full"))
    found = boundary_shift(*made, *args, paired=True, resamples=200)
    assert found
    for row in found:
        assert row["ratio"] == pytest.approx(2.0, rel=1e-9)
        assert row["ratio_low"] == pytest.approx(row["ratio_high"], rel=1e-9)  # the same draws
    apart = boundary_shift(*made, *args, paired=False, resamples=200)
    assert all(row["ratio_low"] < 1.99 < 2.01 < row["ratio_high"] for row in apart)


def fabricated(rows: pd.DataFrame) -> pd.DataFrame:
    """HME2 made better at rest and worse in motion than HME1, so that there is a boundary."""
    upper = rows[rows.scheme == "HME1"]
    factor = 1.0 + 0.1 * upper.replicate
    lower = upper.assign(scheme="HME2", motion=upper.motion * 2.0 * factor, noise=0.5 * upper.noise)
    return pd.concat([upper, lower], ignore_index=True)


def comparison(values: list[dict]) -> Comparison:
    from types import SimpleNamespace

    runs = tuple(SimpleNamespace(values=own) for own in values)
    return Comparison(tuple(values[0]), (), runs, (Pair(0, 1, ""),))  # type: ignore[arg-type]


def test_panels_put_the_first_key_across_and_leave_holes():
    grid = [{"a": a, "b": b} for a in (1.0, 2.0) for b in (5.0, 6.0, 7.0)]
    panels = arrange(comparison(grid[:-1]))
    assert panels is not None
    assert panels.runs == [[0, 3], [1, 4], [2, None]]
    assert panels.titles[1][1] == "a = 2\nb = 6"
    one = arrange(comparison([{"a": float(i)} for i in range(6)]))
    assert one is not None
    assert one.runs == [[0, 1, 2, 3], [4, 5, None, None]]
    assert arrange(comparison([{"a": 1, "b": 2, "c": i} for i in range(2)])) is None
    assert arrange(comparison([{"a": float(i)} for i in range(31)])) is None
