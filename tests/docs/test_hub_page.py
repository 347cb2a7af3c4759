"""The numbers of docs/hub.md on the two maps are those of the kept tables."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pandas as pd

from owtsweep.config.stored import read_stored

ROOT = Path(__file__).parents[2]
KEPT = ROOT / "results" / "reference"
PAGE = " ".join((ROOT / "docs/hub.md").read_text(encoding="utf-8").split())


def read_map(run):
    best = pd.read_csv(KEPT / f"{run}/best_scheme.csv")
    return best[best["criterion"] == "position"]


def test_what_is_said_of_the_matched_map():
    told = r"run HME1 where the motion is larger than some (\.\d) m, and MKF from some (\.\d+) to"
    ((hme1_from, mkf_from),) = re.findall(told, PAGE)
    best = read_map("default")
    assert set(best.loc[best["amplitude"] > 0.2, "best"]) == {"HME1"}
    assert set(best.loc[best["amplitude"] == 0.2, "best"]) == {"MKF"}
    small = best["amplitude"] <= 0.1
    assert (best["baseline_wins"] == small).all()
    assert set(best.loc[small, "baseline"]) == {"NONE"}
    # between the cells: errors of MKF and of zero grow as the square of the amplitude
    wide = best.pivot(index="natural_period", columns="amplitude", values="mse_best")
    growth = (wide[0.2] - wide[0.1]) / (0.2**2 - 0.1**2)
    steady = wide[0.1] - growth * 0.1**2
    of_zero = best[small].groupby("natural_period")["mse_baseline"].first() / 0.05**2
    equal = np.sqrt(steady / (of_zero - growth))
    assert np.allclose(equal, float(mkf_from), atol=0.006)
    equal = np.sqrt((wide[0.5] - steady) / growth)
    assert np.allclose(equal, float(hme1_from), atol=0.06)


def test_what_is_said_of_the_papers_map():
    best = read_map("paper").set_index("amplitude")["best"]
    assert set(best) == {"HME1", "HME2"}
    assert set(best[best.index < 1.0]) == {"HME2"}
    numbers = pd.read_csv(KEPT / "paper/fidelity_numbers.csv")
    assert f"{(numbers['chance'] >= 0.05).sum()} of its 64 numbers, each by itself, could" in PAGE
    claims = pd.read_csv(KEPT / "paper/fidelity.csv").query("kind == 'statement'")
    held = (claims["agrees"] == "reproduced").sum()
    assert f"{held} of its {len(claims)} statements hold" in PAGE


def test_the_truth_of_the_map_is_named():
    config, _ = read_stored(KEPT / "default/config.yaml")
    imu, records = config["sensors"]["imu"], config["grid"]["replicates"]
    told = (config["record"]["duration"], imu["bias_initial"], imu["bias_walk"], records)
    assert told == (1000.0, 0.02, 1e-4, 100)
    assert config["seed"] == 2019
    assert config["measures"]["window"] == "full"
    told = "records of 1000 s, IMU bias .02 m/s² with a walk of 1e-4 m/s²/√s, 100 records"
    assert told in PAGE


def test_skfa_beside_the_best_of_the_four():
    table = pd.read_csv(KEPT / "better/efficiency.csv").query(
        "measure == 'position' and natural_period == 4"
    )
    wide = 1e3 * np.sqrt(table.pivot_table(index="amplitude", columns="scheme", values="mse"))
    wide["best of the four"] = wide[["EKF", "MKF", "HME1", "HME2"]].min(axis=1)
    for name in ("SKFA", "best of the four"):
        (told,) = re.findall(rf"\| {name} \| (\S+) mm \| (\S+) mm \| (\S+) mm \| (\S+) mm \|", PAGE)
        found = wide.loc[[0.05, 0.2, 1.0, 10.0], name].to_numpy()
        assert np.allclose(found, [float(number) for number in told], rtol=0.035)
    (told,) = re.findall(r"\| no estimator \| (\d+) mm \|", PAGE)
    assert abs(wide.loc[0.05, "NONE"] - float(told)) < 0.5
