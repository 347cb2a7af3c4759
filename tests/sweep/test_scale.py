"""Large plans: laid out, stopped, resumed and aggregated in bounded memory.

Each in a process of its own, because the peak of a process never goes down.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from owtsweep.studies import compose, get_study
from owtsweep.sweep.plan import count_cases, make_plan

ROOT = Path(__file__).parents[2]
#: An interpreter with all that a sweep imports, before it has planned anything (10^6 bytes).
BARE = 180


def measure(*arguments: str, folder: Path) -> dict:
    done = subprocess.run(
        [sys.executable, "-m", "benchmarks.scale", *arguments],
        cwd=ROOT,
        capture_output=True,
        text=True,
        env={**os.environ, "TMPDIR": str(folder)},
    )
    assert done.returncode == 0, done.stdout + done.stderr
    found = json.loads(done.stdout.splitlines()[-1])
    assert found["correct"]
    return found


def test_a_hundred_thousand_cases(tmp_path: Path) -> None:
    found = measure("--cases=100000", "--per-block=400", folder=tmp_path)
    assert found["cases"] == 100_000
    assert found["blocks"] == 252
    assert found["peak_MB"] < BARE + 200e-6 * found["cases"]


@pytest.mark.faults
def test_aggregating_the_hub_study_takes_a_fixed_memory_per_row(tmp_path: Path) -> None:
    found = measure("--hub=300", folder=tmp_path)
    assert found["rows"] == 300 * 6 * 4 * 16
    # Rows of long text at ten amplitudes each were more than a kilobyte. 150 MB are what reading
    # and drawing import: a fifth of the rows took 20 MB less, so a row takes some 220 bytes.
    assert found["peak_MB"] < BARE + 150 + 250e-6 * found["rows"]


def test_a_plan_of_two_million_cases_shares_what_its_blocks_have_in_common() -> None:
    config = compose(["grid.replicates=10000", "tuning=paper", "baselines=[]"])
    plan = make_plan(get_study("hub"), config)
    assert count_cases(plan) == 2_400_000
    one, other = (block.content for block in list(plan.values())[:5:4])
    assert one["replicates"] != other["replicates"]
    for name in ("tuning", "sensors", "record", "spectrum"):
        assert one[name] is other[name]


@pytest.mark.faults
def test_a_million_cases(tmp_path: Path) -> None:
    found = measure("--cases=1000000", "--per-block=80", folder=tmp_path)
    assert found["cases"] == 1_000_000
    assert found["blocks"] == 12_500
    assert found["peak_MB"] < 1000


@pytest.mark.faults
def test_five_thousand_replicates_of_the_hub_study(tmp_path: Path) -> None:
    found = measure("--hub=5000", folder=tmp_path)
    assert found["cases"] == 1_200_000
    assert found["peak_MB"] < 1000
