"""What docs/plant.md and docs/hub.md say of seas is what the kept answer says."""

import re
from pathlib import Path

import pytest

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


@pytest.mark.parametrize("tuning", ["matched", "paper"])
def test_from_which_wave_height_hme1_is_best(tuning):
    page = (ROOT / "docs/plant.md").read_text("utf-8")
    (row,) = re.findall(rf"^\| `tuning={tuning}` \|(.*)\|$", page, flags=re.MULTILINE)
    told = [cell.strip().removesuffix(" m") for cell in row.split("|")]
    assert told == [read_answer(tuning).get(period, "") for period in PERIODS]


def test_the_same_on_the_page_of_the_hub():
    page = (ROOT / "docs/hub.md").read_text("utf-8")
    (row,) = re.findall(r"^\| HME1 from Hs \|(.*)\|$", page, flags=re.MULTILINE)
    told = [cell.strip().removesuffix(" m") for cell in row.split("|")]
    answer = read_answer("matched")
    assert told == [answer[period] for period in (4, 6, 7, 9, 10)]
    assert (answer[4], answer[7]) == (answer[5], answer[8])
