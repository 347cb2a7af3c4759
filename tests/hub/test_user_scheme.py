"""A user's scheme in a study, beside ours: values, and what becomes of one that fails."""

from __future__ import annotations

import numpy as np
import pytest
from tools import Key, configure, rows_of, whole_series

from owtsweep.studies.hub import blocks
from owtsweep.studies.hub.records import make_records

pytestmark = pytest.mark.usefixtures("kernels")

SCHEMES = "schemes=[MKF,{_target_: hold_last_fix.HoldLastFix}]"
AMPLITUDE = 0.7


@pytest.mark.parametrize("evaluation", ["superposed", "direct"])
def test_it_runs_beside_ours(evaluation: str) -> None:
    config = configure(
        SCHEMES, f"evaluation={evaluation}", f"grid.amplitude=[{AMPLITUDE}]", "record.duration=12"
    )
    rows = rows_of(config)
    assert {key.scheme for key in rows} == {"MKF", "HoldLastFix"}
    records = make_records(config, 4.0, [0])
    fixes = np.repeat(whole_series(records, AMPLITUDE).fixes, 10, axis=0)
    truth = AMPLITUDE * np.outer(records.motion[0].position, records.direction)
    expected = np.mean(np.sum((fixes - truth) ** 2, axis=1))
    at = AMPLITUDE if evaluation == "direct" else None
    row = rows[Key(4.0, "HoldLastFix", "position", "full", at, 0)]
    value = row["value"]
    if evaluation == "superposed":
        N = AMPLITUDE
        value = N**2 * row["motion"] + 2 * N * row["cross"] + row["noise"]
    assert value == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize(
    ("fault", "reason"),
    [("raise", "RuntimeError: no more"), ("nan", "estimate of step 30 is not finite"),
     ("shape", r"position of step 30 has the shape \(3,\)")],
)  # fmt: skip
def test_a_failing_case_gives_its_reason_and_the_rest_goes_on(fault: str, reason: str) -> None:
    config = configure(
        f"schemes=[{{_target_: failing_scheme.Failing, fault: {fault}}},MKF]", "record.duration=12"
    )
    done = {
        block.content["scheme"]: rows for block, rows in blocks.run(config, blocks.plan(config))
    }
    assert (done["MKF"]["status"] == "ok").all()
    assert (done["Failing"]["status"] == "failed").all()
    assert len(done["Failing"]) == 1
    assert done["Failing"]["reason"].str.contains(reason).all()


def test_its_source_is_part_of_its_blocks() -> None:
    ours, theirs = blocks.plan(configure(SCHEMES))
    assert "source" not in ours.content
    assert len(theirs.content["source"]) == 16
    assert theirs.content["entry"] == {"_target_": "hold_last_fix.HoldLastFix"}
