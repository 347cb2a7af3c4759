"""Regret against sums written out, and its ranges against draws made anew."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from owtsweep.results.conditions import Condition
from owtsweep.results.criteria import Criterion
from owtsweep.results.cube import Cube
from owtsweep.results.regret import Judged, make_map_table, make_regret, tell_regret
from owtsweep.statistics.inference import RESAMPLES, resample_means

CONDITIONS = (Condition("wind", "wind speed", "m/s"), Condition("sea", "sea state"))
SQUARE = Judged("error", Criterion("error", "square", "m", 0.001, "none"), "settled")
SCHEMES, WORLDS, RECORDS = ["A", "B", "C"], ["nominal", "fog"], 12
OVER = {"world": WORLDS}
SENTENCES = {"nominal": "as schemes are told", "fog": "nobody sees far"}
rng = np.random.default_rng(3)
#: World, wind (2 values), scheme, record.
VALUES = rng.gamma(3.0, size=(2, 2, 3, RECORDS)) * np.array([1.0, 2.0, 4.0])[:, None]
VALUES[1, :, 0] *= 9.0


def make_cube(values: np.ndarray, drop: tuple[int, ...] = ()) -> Cube:
    """Return a cube of values (wind, scheme, record), without some records of scheme A."""
    rows = [
        {
            "wind": float(wind), "sea": 1.0, "scheme": name, "replicate": record,
            "measure": "error", "window": "settled", "status": "ok", "reason": "",
            "motion": np.nan, "cross": np.nan, "noise": np.nan,
            "value": values[wind, scheme, record],
        }
        for wind in range(2)
        for scheme, name in enumerate(SCHEMES)
        for record in range(RECORDS)
        if not (name == "A" and record in drop)
    ]  # fmt: skip
    grid = {"wind": [0.0, 1.0], "sea": [1.0]}
    return Cube.of_rows(pd.DataFrame(rows), SCHEMES, CONDITIONS, grid)


def make_tables(over: dict[str, list] = OVER, drop: tuple[int, ...] = ()) -> dict:
    cubes = {"nominal": make_cube(VALUES[0]), "fog": make_cube(VALUES[1], drop)}
    return make_regret(cubes, over, SQUARE, SENTENCES)


def test_regret_is_the_error_over_the_least_one_of_the_world():
    tables = make_tables()
    error = np.sqrt(VALUES.mean(axis=-1))
    regret = error / error.min(axis=-1, keepdims=True)
    lines = tables["regret"].set_index(["wind", "world", "scheme"])
    summary = tables["regret_summary"].set_index(["wind", "scheme"])
    for wind in range(2):
        for s, name in enumerate(SCHEMES):
            for w, world in enumerate(WORLDS):
                line = lines.loc[(wind, world, name)]
                assert line["error"] == pytest.approx(error[w, wind, s])
                assert line["least"] == pytest.approx(error[w, wind].min())
                assert line["best"] == SCHEMES[error[w, wind].argmin()]
                assert line["regret"] == pytest.approx(regret[w, wind, s])
                assert (line["weight"], line["n"]) == (0.5, RECORDS)
            line = summary.loc[(wind, name)]
            assert line["mean"] == pytest.approx(regret[:, wind, s].mean())
            assert line["worst"] == pytest.approx(regret[:, wind, s].max())
            assert line["worst_world"] == WORLDS[regret[:, wind, s].argmax()]
        chosen = tables["regret_summary"].query("wind == @wind and least_mean")["scheme"]
        assert [*chosen] == [SCHEMES[regret[:, wind].mean(axis=0).argmin()]]


def test_declared_weights_enter_the_mean_and_not_the_worst():
    equal, weighted = (
        make_tables(over)["regret_summary"] for over in (OVER, OVER | {"weights": [3, 1]})
    )
    lines = make_tables(OVER | {"weights": [3, 1]})["regret"]
    regret = lines.pivot(index=["wind", "scheme"], columns="world", values="regret")
    expected = 0.75 * regret["nominal"] + 0.25 * regret["fog"]
    found = weighted.set_index(["wind", "scheme"])["mean"]
    pd.testing.assert_series_equal(found.sort_index(), expected.sort_index(), check_names=False)
    assert [*weighted["worst"]] == [*equal["worst"]]


def test_ranges_are_those_of_paired_draws_of_records():
    draws = resample_means(np.eye(RECORDS), (41,)) * RECORDS  # how often each record is drawn
    assert draws.shape == (RESAMPLES, RECORDS)
    error = np.sqrt(np.einsum("dr,wsr->dws", draws, VALUES[:, 0]) / RECORDS)
    regret = error / error.min(axis=-1, keepdims=True)
    lines = make_tables()["regret_summary"].query("wind == 0").set_index("scheme")
    for s, name in enumerate(SCHEMES):
        for kind, drawn in (("mean", regret.mean(axis=1)), ("worst", regret.max(axis=1))):
            low, high = lines.loc[name, [f"{kind}_low", f"{kind}_high"]]
            assert low == pytest.approx(np.quantile(drawn[:, s], 0.025), rel=1e-3)
            assert high == pytest.approx(np.quantile(drawn[:, s], 0.975), rel=1e-3)
            assert low <= lines.loc[name, kind] <= high


def test_records_that_a_scheme_lacks_in_one_world_count_in_none():
    tables = make_tables(drop=(0, 5))
    kept = np.delete(VALUES[0, 0], [0, 5], axis=-1)
    line = tables["regret"].query("wind == 0 and world == 'nominal' and scheme == 'B'").iloc[0]
    assert line["n"] == RECORDS - 2
    assert line["error"] == pytest.approx(np.sqrt(kept[1].mean()))


def test_a_scheme_without_records_in_a_world_has_no_regret_over_the_worlds():
    tables = make_tables(drop=tuple(range(RECORDS)))
    assert "A" not in {*tables["regret_summary"]["scheme"]}
    assert {*tables["regret"].query("world == 'nominal'")["scheme"]} == {*SCHEMES}
    assert tables["regret_summary"]["n"].eq(RECORDS).all()


def test_one_record_has_no_ranges():
    table = make_cube(VALUES[0]).to_table().query("replicate == 0")
    assert len(table) == 6
    rows = table.assign(status="ok", reason="", motion=np.nan, cross=np.nan, noise=np.nan)
    cube = Cube.of_rows(rows, SCHEMES, CONDITIONS, {"wind": [0.0, 1.0], "sea": [1.0]})
    tables = make_regret({"nominal": cube}, {"world": ["nominal"]}, SQUARE, SENTENCES)
    lines = tables["regret_summary"]
    assert lines["mean_low"].isna().all()
    assert (lines["n"] == 1).all()


def test_the_answer_names_who_regrets_least_and_claims_no_victory():
    several = tell_regret(make_tables())
    tables = make_tables()
    one = tables | {"regret_summary": tables["regret_summary"].query("wind == 0")}
    assert several[0].startswith("If nobody knows the world (over 2 worlds, equal weights): least")
    assert "of 2 cells" in several[0]
    assert "(95 %: " in tell_regret(one)[0]
    assert several[1].endswith(("(fog: nobody sees far).", "nominal."))
    assert "won" not in " ".join(several + tell_regret(one))
    assert tell_regret({}) == []


def test_a_map_shows_the_least_regret_and_the_next():
    summary = make_tables()["regret_summary"]
    table = make_map_table(summary, CONDITIONS, "worst")
    for row in table.to_dict("records"):
        ranked = summary[summary["wind"] == row["wind"]].sort_values("worst")
        assert [row["best"], row["runner_up"]] == [*ranked["scheme"][:2]]
        assert row["error_best"] == ranked["worst"].iloc[0]
        assert row["verdict"] == ""
