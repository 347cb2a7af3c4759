"""A structure's envelope on the map of a run: which scheme, in which sea."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

import owtsweep
from owtsweep.cli import main
from owtsweep.errors import InputError
from owtsweep.studies import compose
from owtsweep.studies.hub.figures import envelope
from owtsweep.studies.hub.figures.envelope import find_best, tell_best
from owtsweep.waves import Sea


def make_points(**columns: list[float]) -> pd.DataFrame:
    points = pd.DataFrame(columns)
    return points.assign(blades=0, friction_angle=np.nan, rms=points["amplitude"] / 3.0)


def make_best() -> pd.DataFrame:
    cells = [(3.0, 0.1, "A"), (3.0, 1.0, "B"), (5.0, 0.1, "C"), (5.0, 1.0, "D")]
    table = pd.DataFrame(cells, columns=["natural_period", "amplitude", "best"])
    return table.assign(criterion="position", window="full")


def test_a_point_takes_the_nearest_cell_on_the_maps_scales():
    points = make_points(
        natural_period=[3.9, 4.1, 3.9, 3.9, 6.1, 4.9, 4.9],
        amplitude=[0.31, 0.31, 0.32, 3.2, 0.3, 0.03, 1.1],
    )
    config = compose(["tuning=paper", "measures.window=full"])
    found = ["A", "C", "B", "", "", "", "D"]
    assert find_best(config, make_best(), points) == found  # type: ignore[arg-type]
    config = compose(
        ["tuning=paper", "normalise=rms", "measures.window=full"]
    )  # then .31 m is .1 m rms
    assert find_best(config, make_best(), points)[2:4] == ["A", "B"]  # type: ignore[arg-type]


def test_a_map_without_area_is_refused():
    best, config = make_best(), compose(["tuning=paper", "measures.window=full"])
    points = make_points(natural_period=[3.0], amplitude=[0.1])
    for name, value in (("natural_period", 3.0), ("amplitude", 0.1)):
        with pytest.raises(InputError, match=rf"grid\.{name}: .* give two or more"):
            find_best(config, best[best[name] == value], points)  # type: ignore[arg-type]


def test_the_answer_names_scheme_and_sea():
    points = make_points(
        natural_period=[4.0] * 6, amplitude=[0.1, 0.2, 0.4, 0.05, 0.1, 0.2],
        hs=[1.0, 2.0, 3.0] * 2, tp=[4.0] * 3 + [8.0] * 3,
    ).assign(best_mine=["MKF", "HME1", "HME1", "MKF", "MKF", "MKF"])  # fmt: skip
    assert tell_best(points, "mine") == (
        "Tuning mine: over all seas, blades and soils, best is MKF in 67 % (motion of 0.05 to "
        "0.2 m), HME1 in 33 % (motion of 0.2 to 0.4 m). Without blades and with the soil as "
        "described, HME1 is best in seas from Hs 2 m at Tp 4 s on, in none at Tp 8 s; in lower "
        "seas MKF."
    )
    outside = points.assign(best_mine=["", "HME1", "HME1", "", "HME1", "HME1"])
    told = tell_best(outside, "mine")
    assert "HME1 in 67 %" in told
    assert (
        "; at 2 of 6 points (33 %) the map names no scheme (motion of 0.05 to 0.1 m). Without"
        in told
    )
    assert told.endswith("; at 2 of 6 seas (33 %) the map names no scheme.")
    nowhere = tell_best(points.assign(best_mine=""), "mine")
    assert nowhere == "Tuning mine: the map names a scheme at none of the 6 points."
    one = pd.concat([points.assign(best_mine=""), points.iloc[:1].assign(blades=1)])
    assert tell_best(one, "mine").endswith(
        "; at 6 of 7 points (86 %) the map names no scheme (motion of 0.05 to 0.4 m). Without "
        "blades and with the soil as described, no sea lies where the map names a scheme."
    )


def test_a_cell_without_a_result_names_no_scheme():
    points = make_points(natural_period=[3.0, 5.0], amplitude=[0.1, 1.0])
    config, best = compose(["tuning=paper", "measures.window=full"]), make_best()
    assert find_best(config, best.iloc[:3], points) == ["A", ""]  # type: ignore[arg-type]
    best.loc[3, "best"] = np.nan
    assert find_best(config, best, points) == ["A", ""]  # type: ignore[arg-type]


def test_figures_draws_the_envelope_over_the_map(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    run = owtsweep.run(
        [
            "grid.natural_period=[3.0,4.0,5.0]", "grid.amplitude=[0.2,1.0]", "schemes=[MKF,HME1]",
            "sensors.imu.rate=20", "record.duration=20", "grid.replicates=2", "baselines=[]",
            "measures.settling_time=5", "tuning=[paper,matched]", f"results={tmp_path}",
        ]
    )  # fmt: skip
    monkeypatch.setattr(envelope, "list_seas", lambda: [Sea(2.0, 6.0)])
    assert main(["figures", str(run.folder), "--envelope", "ren2019"]) == 0
    told = capsys.readouterr().out
    assert "Tuning paper: " in told
    assert "Tuning matched: " in told
    assert "3 files" in told
    names = {path.name for path in (run.folder / "figures").glob("envelope*")}
    assert names == {"envelope.png", "envelope.svg", "envelope.csv"}
    table = pd.read_csv(run.folder / "figures" / "envelope.csv")
    assert list(table.columns) == [
        "hs", "tp", "blades", "friction_angle", "natural_period", "fitted_period", "amplitude",
        "rms", "best_paper", "best_matched",
    ]  # fmt: skip
    assert len(table) == 3 * 5
    assert main(["figures", str(run.folder), "--envelope", "nobody"]) == 2
    assert "there is no 'nobody'; use iea15, oc3_monopile, ren2019" in capsys.readouterr().err
