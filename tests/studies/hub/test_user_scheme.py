"""A user's scheme in a study, beside ours: values, and what becomes of one that fails."""

from __future__ import annotations

import sys
import types

import numpy as np
import pytest
from hold_last_fix import HoldLastFix
from hostile_schemes import ERRORS, GARBAGE
from tools import SMALL, Key, configure, plan_blocks, rows_of, run_blocks, whole_series

from owtsweep.errors import InputError
from owtsweep.studies import compose, get_study
from owtsweep.studies.hub.records import make_records
from owtsweep.sweep.run import sweep

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
        block.content["scheme"]: rows for block, rows in run_blocks(config, plan_blocks(config))
    }
    assert (done["MKF"]["status"] == "ok").all()
    assert (done["Failing"]["status"] == "failed").all()
    assert len(done["Failing"]) == 1
    assert done["Failing"]["reason"].str.contains(reason).all()


BROKEN = (
    *(f"hostile_schemes.Made, how: {how}" for how in ERRORS),
    *(
        f"hostile_schemes.{name}"
        for name in (
            "Name", "Linear", "Under", "UnderNothing", "Sections", "NoSections", "TextSections",
            "OddSections", "Batched", "Version", "NumberName", "NoStart", "Abstract", "WithMeta",
        )
    ),
    "hostile_module.Anything", "3", "''", ".x", "x.", "hostile_schemes.", "..",
)  # fmt: skip


@pytest.mark.parametrize("target", BROKEN)
def test_a_broken_class_is_refused_in_one_line(target: str) -> None:
    with pytest.raises(InputError, match=r"^schemes: ") as caught:
        plan_blocks(configure(f"schemes=[MKF,{{_target_: {target}}}]"))
    assert str(caught.value).isprintable()


def test_a_chain_that_lacks_its_kernel_is_refused() -> None:
    with pytest.raises(InputError, match="batched = 'chain', but it lacks the method kernel"):
        configure("schemes=[MKF,{_target_: user_schemes.Kernelless}]")


RUNNING = [
    *(("Running", "start", how) for how in ERRORS),
    *(("Running", "update", how) for how in ERRORS),
    *(("Running", "garbage", how) for how in GARBAGE),
    *(("Running", "recorded", how) for how in ("row", "texts", "array")),
    *(("Kernels", "kernel", how) for how in ERRORS),
    *(("Kernels", "garbage", how) for how in ("none", "damaged")),
]


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize(("name", "where", "how"), RUNNING)
def test_a_scheme_that_breaks_off_takes_nothing_else_down(name, where, how) -> None:
    """In one task with ours, the first of which runs all kernels."""
    config = configure(
        f"schemes=[MKF,{{_target_: hostile_schemes.{name}, where: {where}, how: {how}}},EKF]",
        "record.duration=12", "grid.replicates=2",
    )  # fmt: skip
    left, done = plan_blocks(config), {}
    while left:  # as a worker does: the block that was due fails, and those after it are run
        try:
            for block, rows in run_blocks(config, left):
                done[block.content["scheme"]] = rows
        except Exception as error:
            due = next(b for b in left if b.content["scheme"] not in done)
            done[due.content["scheme"]] = error
        left = [block for block in left if block.content["scheme"] not in done]
    assert (done["MKF"]["status"] == "ok").all()
    assert (done["EKF"]["status"] == "ok").all()
    if name == "Running":
        assert list(done[name]["status"]) == ["failed", "failed"]
        assert done[name]["reason"].map(lambda reason: reason.isprintable() and reason).all()
    else:
        assert isinstance(done[name], Exception)


def test_its_source_is_part_of_its_blocks() -> None:
    ours, theirs = plan_blocks(configure(SCHEMES))
    assert "source" not in ours.content
    assert len(theirs.content["source"]) == 16
    assert theirs.content["entry"] == {"_target_": "hold_last_fix.HoldLastFix"}


def test_a_scheme_without_source_is_computed_anew_and_says_why(tmp_path, monkeypatch, caplog):
    """Its stored results may be those of another version; a version = ... keeps them."""
    module = types.ModuleType("typed_into_a_notebook")
    module.Mine = type("Mine", (HoldLastFix,), {"__module__": module.__name__, "name": "Mine"})
    monkeypatch.setitem(sys.modules, module.__name__, module)
    words = [*SMALL, "compute.backend=threading", f"results={tmp_path}"]
    words.append("schemes=[MKF,{_target_: typed_into_a_notebook.Mine}]")

    def sweep_again() -> tuple[int, int]:
        config = compose(words)
        outcome = sweep(get_study("hub"), config)
        return outcome.computed, outcome.reused

    assert sweep_again() == (6, 0)
    caplog.clear()
    assert sweep_again() == (3, 3)
    (told,) = [r.getMessage() for r in caplog.records if "recomputed" in r.getMessage()]
    assert "the source of Mine cannot be read" in told
    assert "version = ..." in told
    module.Mine.version = 1
    assert sweep_again() == (3, 3)  # another key
    assert sweep_again() == (0, 6)
