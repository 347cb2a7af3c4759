"""The benchmarks measure the right thing, and their report says what they found."""

from __future__ import annotations

import builtins
import math
import sys
from pathlib import Path
from typing import Any

import pytest
from benchmarks.parts import PARTS, measure_part

pytestmark = pytest.mark.usefixtures("kernels")


@pytest.fixture
def found() -> dict[str, Any]:
    """Numbers as a run gives them, all goals reached."""
    kernel = {
        "tuning": "paper", "series": 256, "flops": 80.0, "bytes": 33.0, "ns_memory": 1.0,
        "ns_arithmetic": 2.0, "ns_least": 2.4, "ns_median": 2.5, "ns_cached": 2.2, "share": 0.8,
        "share_of_best": 0.75,
        "triad_GB_per_s": 30.0, "multiply_add_Gflop_per_s": 50.0,
    }  # fmt: skip
    common = {"wall": 1.0, "compute": 1.0, "compute_wall": 1.0, "peak": 300.0, "bytes": 1e5}
    points = [{**common, "value": v, "compute_wall": 1.0 / v} for v in (1, 2)]
    return {
        "quick": False,
        "machine": {
            "date": "-", "CPU": "-", "cores": "2", "last cache": "-", "memory": "-", "system": "-",
            "Python": "-",
        },
        "busy_before": 0.0, "busy_after": 0.0, "failed": {}, "spent": {"kernels": 1.0},
        "kernels": [
            {**kernel, "scheme": scheme, "threads": n, "multiply_add_Gflop_per_s": 50.0 * n}
            for scheme in ("EKF", "MKF", "HME1", "HME2")
            for n in (1, 2)
        ],
        "reference": [{"scheme": s, "ns": 5e5} for s in ("EKF", "MKF", "HME1", "HME2")],
        "study": {
            "replicates": 100,
            "whole": {"wall": 20.0, "process": 21.0, "peak": 500.0, "bytes": 1e6, "cases": 24000.0},
            "axes": [
                {"axis": axis, "exponent": 1.0, "points": points}
                for axis in ("replicates", "duration", "workers")
            ],
            "long": 840.0,
        },
        "startup": [{"what": "start", "seconds": 0.01, "goal": 0.1, "note": "a note"}],
    }  # fmt: skip


def test_verdicts_follow_the_numbers(found: dict[str, Any]) -> None:
    from benchmarks.goals import must_reach

    assert all(goal.reached for goal in must_reach(found))
    # 4 x 0.5 ms x 200 000 steps = 400 s per cell; 60 cells / 0.2 s = 120 000
    assert any("120000 times: 400 s" in goal.measured for goal in must_reach(found))
    found["study"]["whole"] |= {"process": 35.1, "peak": 1001.0}
    found["study"]["axes"][1]["exponent"] = 1.06
    found["kernels"][3]["share"] = 0.24  # MKF, two threads
    found["startup"][0]["seconds"] = 0.11
    missed = [goal for goal in must_reach(found) if not goal.reached]
    assert len(missed) == 5
    assert all(goal.why for goal in missed)


def test_long_records_have_a_goal_where_they_were_measured(found: dict[str, Any]) -> None:
    from benchmarks.goals import also_asked

    (goal,) = (goal for goal in also_asked(found) if "16 000 s" in goal.what)
    assert goal.reached
    found["study"]["long"] = 1001.0
    assert not next(goal for goal in also_asked(found) if "16 000 s" in goal.what).reached
    del found["study"]["long"]
    assert not any("16 000 s" in goal.what for goal in also_asked(found))


def test_a_quick_reference_leaves_the_other_goal_alone(found: dict[str, Any]) -> None:
    from benchmarks.goals import must_reach

    for row in found["reference"]:
        row["ns"] = 1e5  # 80 s per cell
    (goal,) = (goal for goal in must_reach(found) if "engine=reference" in goal.what)
    assert goal.reached is None


def test_the_report_says_what_spoils_it(found: dict[str, Any], tmp_path: Path) -> None:
    from benchmarks.report import write

    text = write(found, tmp_path).read_text()
    assert "MISSED" not in text
    assert "was quiet" in text
    assert "below are too high" not in text
    for picture in ("kernels.png", "study.png"):
        assert (tmp_path / picture).stat().st_size < 100_000
    found |= {"busy_after": 0.5, "failed": {"online": "ValueError: no"}}
    for row in found["kernels"]:
        row["multiply_add_Gflop_per_s"] = 50.0
    text = write(found, tmp_path).read_text()
    assert "not quiet" in text
    assert "too high" in text
    assert "online failed: ValueError: no" in text


def test_filters_of_others_give_our_states(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchmarks import peers_filter

    wrong = ("wrong", "", lambda job: lambda: 1.001 * peers_filter.batched(job)())
    monkeypatch.setattr(peers_filter, "PEERS", (*peers_filter.PEERS[:3], wrong))
    rows = peers_filter.measure(33.0, repeats=1)
    assert [row["agrees"] for row in rows] == [True, True, True, False]


def test_a_missing_peer_is_named_and_skipped(monkeypatch: pytest.MonkeyPatch) -> None:
    from benchmarks import peers_mhe

    real = builtins.__import__

    def without(name: str, *rest: Any, **options: Any) -> Any:
        if name in ("osqp", "do_mpc"):
            raise ImportError(f"No module named {name!r}")
        return real(name, *rest, **options)

    for name in ("osqp", "do_mpc"):
        monkeypatch.delitem(sys.modules, name, raising=False)
    monkeypatch.setattr(builtins, "__import__", without)
    rows = {row["peer"]: row for row in peers_mhe.measure(4, repeats=1)}
    assert rows["OSQP"]["seconds"] is None
    assert "osqp" in rows["OSQP"]["note"]
    assert rows["CasADi qrqp"]["agrees"]


#: Parts whose smallest size takes more than some 2 s: processes of their own, compiled engines.
SLOW = {"kernels", "reference", "startup", "study", "expected"}


@pytest.mark.parametrize(
    "name",
    [pytest.param(n, marks=[pytest.mark.faults] if n in SLOW else []) for n in PARTS],
)
def test_every_part_runs(name: str) -> None:
    assert measure_part(name, "least")


def test_slope_of_a_power() -> None:
    from benchmarks.study import slope

    assert math.isclose(slope([(x, 3.0 * x**0.7) for x in (1.0, 2.0, 5.0)]), 0.7)


def test_work_is_counted_by_hand() -> None:
    """A filter alone: 27 per lane and step, 9 more where a fix is applied, and the error sums."""
    from benchmarks.kernels import prepared, work

    chain, _, _ = prepared("MKF", 8, 1000, "matched")
    counted = work(chain, 1000, 10**9)
    fixes = 1.0 / chain.filter.fix_interval
    assert math.isclose(counted.flops, 2 * (27 + 9 * fixes) + 27 + 5 * fixes)
    assert math.isclose(counted.bytes, 32 + 16 * fixes, rel_tol=1e-6)
