"""What makes runs fast and small changes no bit: spans, pieces of noise, schemes side by side."""

from __future__ import annotations

import numpy as np
import pytest
from tools import configure, plan_blocks, run_blocks
from user_schemes import Saturated

from owtsweep.studies.hub import batch
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.kernels.layout import WIDTH
from owtsweep.studies.hub.records import Feed, make_records

SCHEMES = ("EKF", "MKF", "HME1", "HME2")


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("span", [130, 512])
@pytest.mark.parametrize("amplitude", [None, 0.7])
@pytest.mark.parametrize("yaw", [0, 37])
def test_spans_and_company_do_not_show(
    span: int, amplitude: float | None, yaw: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    # a window of 255 steps makes longer chunks than its companions have
    config = configure("hme.smoother_window=255", f"sensors.yaw={yaw}", tuning="matched")
    records = make_records(config, 4.0, range(11))
    chains = [resolve(n).kernel(Known(records.sensors, config), records.steps) for n in SCHEMES]
    assert len({batch.chunk_of(chain)[0] for chain in chains}) == 2

    def run(some: list) -> list[np.ndarray]:
        keep = amplitude is not None
        kept = batch.sum_errors(some, records, 100, amplitude, keep_squared=keep)
        return [np.append(sums.products.ravel(), sums.squared.ravel()) for sums in kept]

    whole = run(chains)
    monkeypatch.setattr("owtsweep.studies.hub.records.SPAN", span)
    for together, chain, expected in zip(run(chains), chains, whole, strict=True):
        np.testing.assert_array_equal(together, expected)
        np.testing.assert_array_equal(run([chain])[0], expected)


def test_noise_in_pieces_is_the_whole_noise() -> None:
    records = make_records(configure("sensors.imu.bias_initial=0.1"), 4.0, [0, 1])
    source = records.force_noise(1)
    pieces = np.concatenate([source.next(n) for n in (1, 7, 250, records.steps - 258)])
    np.testing.assert_array_equal(pieces, records.noise[1].specific_force)


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("yaw", [0, 37])
def test_kernels_are_fed_the_noise_of_the_record(
    yaw: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("owtsweep.studies.hub.records.SPAN", 512)
    records = make_records(configure(f"sensors.yaw={yaw}"), 4.0, [0, 1])
    fed = np.concatenate([span.force.copy() for span in Feed(records).spans(0)])
    for lane, noise in enumerate(records.noise):
        force = noise.specific_force @ records.sensors.rotation.T
        np.testing.assert_array_equal(fed[: records.steps, WIDTH + lane :: WIDTH], force)


def test_amplitudes_are_free_but_for_what_is_not_linear() -> None:
    def plan(amplitudes: int, *changes: str) -> list:
        listed = ",".join(f"{0.1 + 0.01 * i:g}" for i in range(amplitudes))
        return plan_blocks(configure(f"grid.amplitude=[{listed}]", *changes))

    few, many = plan(10), plan(1000)
    assert [block.content for block in few] == [block.content for block in many]
    target = f"{Saturated.__module__}.{Saturated.__qualname__}"
    mixed = plan(10, f"schemes=[MKF,{{_target_: {target}}}]")
    direct = [block.content["amplitude"] for block in mixed if "amplitude" in block.content]
    assert len(mixed) == 1 + 10
    assert len(set(direct)) == 10


@pytest.mark.usefixtures("kernels")
def test_a_scheme_without_a_chain_keeps_no_other_from_its_rows(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    config = configure("schemes=[MKF,HME1,HME2]")
    broken = resolve("HME1")
    monkeypatch.setattr(type(broken), "kernel_for_runs", lambda *_: 1 / 0)
    results = run_blocks(config, plan_blocks(config))
    block, rows = next(results)
    assert block.content["scheme"] == "MKF"
    assert (rows["status"] == "ok").all()
    with pytest.raises(ZeroDivisionError):
        next(results)
