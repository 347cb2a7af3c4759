"""Comparisons of real runs against scipy and plain pandas."""

from __future__ import annotations

import json
import shutil
from functools import cache, partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from PIL import Image
from scipy import stats
from tools import SMALL

import owtsweep
from owtsweep.comparing.changes import compare_boundaries
from owtsweep.errors import InputError
from owtsweep.results.boundary import find_boundary, subtract_schemes
from owtsweep.studies.hub.worlds import CONDITIONS, find_world
from owtsweep.sweep import compare as comparing
from owtsweep.sweep.compare import Compared
from owtsweep.sweep.store import decode, encode

GRID = ["grid.natural_period=[4.0,8.0]", "grid.amplitude=[0.1,0.25,1.0]", "grid.replicates=5"]
WORDS = [*SMALL, *GRID, "schemes=[MKF,HME1,HME2]"]
compare = partial(comparing.compare, load=owtsweep.load)


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


@pytest.fixture(scope="module")
def seeds(folder) -> Compared:
    """A comparison of two runs with other records."""
    return compare([str(folder / "late"), str(folder / "seed")])


@cache
def cases_of(folder: Path) -> pd.DataFrame:
    return owtsweep.load(folder).cases()


def mse(folder: Path, scheme: str, period: float, amplitude: float) -> pd.Series:
    """Position MSE by replicate, from the cases and the formula alone."""
    rows = cases_of(folder)
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


def test_another_seed_is_not_paired_and_gets_welchs_interval(folder, seeds):
    assert any("seed differs" in note and "Welch" in note for note in seeds.notes)
    table = seeds.findings.tables["scheme_changes"]
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
        assert overview["won"][i] == f"{own.distinguishable.sum()} of {len(own)}"


def test_boundaries_are_those_of_each_run(folder, compared):
    table = compared.findings.tables["boundaries"]
    for name in ("early", "late"):
        own = table[table.folder == name].reset_index(drop=True)
        rows = owtsweep.load(folder / name).cases()
        schemes = "HME2", "HME1"
        expected = find_boundary(
            subtract_schemes(rows, CONDITIONS, schemes, "position", "full"), schemes
        )
        pd.testing.assert_frame_equal(own[list(expected.columns)], expected)


def test_the_report_says_what_all_runs_share_and_in_what_they_differ(compared, seeds):
    told = (
        "In all runs: tuning paper, GNSS noise 0.03 m, GNSS rate 2 Hz, IMU noise 0.15 m/s², "
        "IMU rate 20 Hz, IMU bias 0.05 m/s², bias walk 0.001 m/s²/√s, record length 30 s, "
        "records per cell 5, seed 2019. The runs differ in GNSS delay (0.1 s, 0.5 s)."
    )
    assert compared.findings.origin == told
    assert told in (compared.folder / "comparison.md").read_text().splitlines()
    for path in compared.findings.figures:
        if path.suffix == ".svg":
            assert "In all runs: tuning paper, " in path.read_text()
    other = seeds.findings.origin
    assert "seed" not in other.split("The runs differ")[0]
    assert other.endswith(". The runs differ in seed (7, 2019).")


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


@pytest.mark.parametrize(
    ("column", "value"),
    [("noise", np.nan), ("noise", np.inf), ("motion", -np.inf), ("scheme", "OTHER")],
)
def test_sealed_rows_without_a_usable_number_are_one_line(folder, tmp_path, column, value):
    """The seal of a shard shows damage, not forgery: whoever writes a shard can seal it."""
    for name in ("early", "late"):
        shutil.copytree(folder / name, tmp_path / name)
        run = owtsweep.load(tmp_path / name)
        for key in run.plan():
            path = run.store.path(key)
            rows = decode(path.read_bytes(), key, {}).to_pandas()
            path.write_bytes(encode(key, rows.assign(**{column: value}), {}))
    with pytest.raises(InputError, match=r"^runs: none has a finite number of"):
        compare([str(tmp_path / "early"), str(tmp_path / "late")])


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
        own = run.table("best_scheme").query("criterion == 'position'").reset_index(drop=True)
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


def test_a_shifted_boundary_is_a_ratio_with_a_paired_interval(folder):
    rows = owtsweep.load(folder / "early").cases()
    scaled = rows.assign(motion=rows.motion / 4.0, cross=rows.cross / 2.0)  # twice the amplitude
    asked = CONDITIONS, ("HME2", "HME1"), "position", "full"
    made = [subtract_schemes(fabricated(own), *asked) for own in (rows, scaled)]
    found = compare_boundaries(*made, paired=True)
    assert found
    for row in found:
        assert row["ratio"] == pytest.approx(2.0, rel=1e-9)
        assert row["ratio_low"] == pytest.approx(row["ratio_high"], rel=1e-9)  # the same draws
    apart = compare_boundaries(*made, paired=False)
    assert all(row["ratio_low"] < 1.99 < 2.01 < row["ratio_high"] for row in apart)


def fabricated(rows: pd.DataFrame) -> pd.DataFrame:
    """HME2 made better at rest and worse in motion than HME1, so that there is a boundary."""
    upper = rows[rows.scheme == "HME1"]
    factor = 1.0 + 0.1 * upper.replicate
    lower = upper.assign(scheme="HME2", motion=upper.motion * 2.0 * factor, noise=0.5 * upper.noise)
    return pd.concat([upper, lower], ignore_index=True)


def test_what_pairs_records_is_the_same_question_of_every_motion() -> None:
    sea = ["structure=ren2019", "motion.hs=[2.0]", "motion.tp=[8.0]"]
    words = [[], ["motion.envelope=[[0,1],[9,2]]"], ["motion.pace=[[0,1.1]]"], sea]
    plain, grown, *others = (
        find_world(config).list_pairing(config) for config in map(owtsweep.studies.compose, words)
    )
    assert grown == plain  # an envelope changes no phase
    for other in others:
        assert {*other} == {*plain}
        assert other != plain
