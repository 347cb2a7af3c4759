"""What docs/plant.md and docs/hub.md say of seas is what the kept answer says."""

import re
from pathlib import Path

import pandas as pd

ROOT = Path(__file__).parents[2]
ANSWER = (ROOT / "results/reference/plant/answer.md").read_text("utf-8")
PERIODS = range(4, 11)


def read_answer(tuning: str) -> dict[int, str]:
    """Return peak period (s) -> least wave height (m) from which HME1 is best, as texts."""
    (text,) = re.findall(rf"^Tuning {tuning}: .*", ANSWER, flags=re.MULTILINE)
    heights = re.findall(r"([\d.]+) m at Tp (\d+)(?: to (\d+))? s", text)
    return {
        period: height
        for height, first, last in heights
        for period in range(int(first), int(last or first) + 1)
    }


def test_from_which_wave_height_hme1_is_best():
    page = (ROOT / "docs/plant.md").read_text("utf-8")
    (row,) = re.findall(r"^\| `tuning=matched` \|(.*)\|$", page, flags=re.MULTILINE)
    told = [cell.strip().removesuffix(" m") for cell in row.split("|")]
    assert told == [read_answer("matched")[period] for period in PERIODS]


def test_the_same_on_the_page_of_the_hub():
    page = (ROOT / "docs/hub.md").read_text("utf-8")
    (row,) = re.findall(r"^\| HME1 from Hs \|(.*)\|$", page, flags=re.MULTILINE)
    told = [cell.strip().removesuffix(" m") for cell in row.split("|")]
    answer = read_answer("matched")
    assert told == [answer[period] for period in (4, 6, 7, 9, 10)]
    assert (answer[4], answer[7]) == (answer[5], answer[8])


def test_the_maps_on_the_plants_seas():
    page = (ROOT / "docs/research/plant.md").read_text("utf-8")
    maps = pd.read_csv(ROOT / "results/reference/plant/plant_map.csv")
    for words, motion in {
        "spectrum, as in figure 18": "spectrum",
        "plant, Tp 8 s": "Tp 8 s",
        "plant, Tp 6 s": "Tp 6 s",
        "plant, Tp 8 s, IMU that leans by .0137 rad/m": "Tp 8 s, leaning IMU",
    }.items():
        of_motion = maps[maps["motion"] == motion]
        wins = of_motion.groupby("tuning")["best"].value_counts()
        counts = [
            ", ".join(str(wins.get((tuning, scheme), 0)) for scheme in schemes)
            for tuning, schemes in (
                ("matched", ("HME1", "MKF")),
                ("paper", ("HME1", "HME2", "MKF")),
            )
        ]
        paper = of_motion[of_motion["tuning"] == "paper"]
        at = paper.groupby("natural_period")["boundary"].first()
        ends = [f"{at[p]:.2f}" for p in (4.0, 6.0, 8.0)]
        told = (
            f"| {words} | {' | '.join(counts)} | {', '.join(e.removeprefix('0') for e in ends)} |"
        )
        assert told in page, told
    cells = maps.pivot(
        index=["natural_period", "amplitude"], columns=["motion", "tuning"], values="best"
    )
    matched = cells.xs("matched", axis=1, level="tuning")
    assert matched.nunique(axis=1).eq(1).all()
    small = maps[maps["amplitude"] <= 0.1]
    assert small["baseline_wins"].all()
