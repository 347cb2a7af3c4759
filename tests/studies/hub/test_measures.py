"""The measures against plain numpy on trajectories."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest
from tools import Key, configure, plan_blocks, rows_of, run_batch, run_blocks, whole_series

from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.studies.base.declaration import Means
from owtsweep.studies.hub import batch, measures
from owtsweep.studies.hub.contract import resolve
from owtsweep.studies.hub.measures import Sums
from owtsweep.studies.hub.records import make_records

AMPLITUDE = 0.7
SETTLED = 100  # 5 s at 20 Hz


@pytest.mark.usefixtures("kernels")
@pytest.mark.parametrize("name", ["MKF", "HME1", "HME2"])
def test_batch_measures_are_numpy_means(name: str) -> None:
    config = configure(
        f"schemes=[{name}]", "evaluation=direct", "measures.extremes=true", "grid.replicates=2",
        f"grid.amplitude=[{AMPLITUDE}]",
    )  # fmt: skip
    rows = rows_of(config)
    records = make_records(config, 4.0, [0, 1])
    for replicate in (0, 1):
        data = whole_series(records, AMPLITUDE, replicate)
        run = run_batch(resolve(name), config, data, records.sensors)
        motion = records.motion[replicate]
        truth = AMPLITUDE * np.concatenate(
            [np.outer(s, records.direction) for s in (motion.position, motion.velocity)], axis=1
        )
        error = run.state - truth
        for window, start in (("full", 0), ("settled", SETTLED)):

            def value(
                measure: str, count: int, window: str = window, replicate: int = replicate
            ) -> float:
                row = rows[Key(4.0, name, measure, window, AMPLITUDE, replicate)]
                assert row["n_samples"] == count
                return float(row["value"])

            e = error[start:]
            steps = len(e)
            squares = np.mean(e**2, axis=0)
            for i, measure in enumerate(("x", "y", "vx", "vy")):
                assert value(measure, steps) == pytest.approx(squares[i], rel=1e-10)
            assert value("position", steps) == pytest.approx(squares[:2].sum(), rel=1e-10)
            assert value("velocity", steps) == pytest.approx(squares[2:].sum(), rel=1e-10)
            nees = [d @ np.linalg.solve(P, d) for d, P in zip(e, run.reported[start:], strict=True)]
            assert value("nees", steps) == pytest.approx(np.mean(nees), rel=1e-8)
            S = run.innovation_variance[start:]
            nis = np.sum(run.innovation[start:] ** 2, axis=1) / S
            assert value("nis", np.isfinite(S).sum()) == pytest.approx(np.nanmean(nis), rel=1e-9)
            distance = np.hypot(e[:, 0], e[:, 1])
            assert value("position_max", steps) == pytest.approx(distance.max(), rel=1e-10)
            p95 = np.percentile(distance, 95)
            assert value("position_p95", steps) == pytest.approx(p95, rel=1e-10)


def trajectory(seed: int, steps: int = 40) -> Trajectory:
    random = np.random.default_rng(seed)
    half = random.normal(size=(steps, 4, 4))
    S = random.normal(size=(steps, 2, 2))
    covariance = half @ half.transpose(0, 2, 1) + np.eye(4)
    innovation_covariance = S @ S.transpose(0, 2, 1) + np.eye(2)
    innovation = random.normal(size=(steps, 2))
    covariance[:3] = np.nan  # an estimator that has no covariance at first
    innovation[np.arange(steps) % 4 != 0] = np.nan
    return Trajectory(random.normal(size=(steps, 4)), covariance, innovation, innovation_covariance)


def entries(measured: Means) -> dict[tuple[str, str], tuple[list[float], int]]:
    """The products and the number of samples of one record by measure and window."""
    names = zip(measured.measures, measured.windows, strict=True)
    found = zip(measured.products.tolist(), measured.n_samples, strict=True)
    return dict(zip(names, found, strict=True))


def test_trajectory_measures_are_numpy_means() -> None:
    run, truth = trajectory(0), np.random.default_rng(1).normal(size=(40, 4))
    found = entries(measures.from_trajectories(None, run, truth, 10, extremes=True))
    error = run.state - truth
    assert run.covariance is not None
    assert run.innovation is not None
    assert run.innovation_covariance is not None
    for window, start in (("full", 0), ("settled", 10)):
        nees = [error[k] @ np.linalg.inv(run.covariance[k]) @ error[k]
                for k in range(max(start, 3), 40)]  # fmt: skip
        nis = [run.innovation[k] @ np.linalg.inv(run.innovation_covariance[k]) @ run.innovation[k]
               for k in range(start, 40) if k % 4 == 0]  # fmt: skip
        x2, y2 = np.mean(error[start:, :2] ** 2, axis=0)
        largest = np.max(np.hypot(*error[start:, :2].T))
        for name, mean, count in (
            ("nees", np.mean(nees), len(nees)),
            ("nis", np.mean(nis), len(nis)),
            ("position", x2 + y2, 40 - start),
            ("position_max", largest, 40 - start),
        ):
            assert found[name, window] == (pytest.approx((0.0, 0.0, mean)), count)


def test_trajectory_products_superpose() -> None:
    motion, noise = trajectory(2), trajectory(3)
    noise = noise._replace(covariance=motion.covariance)
    motion = motion._replace(innovation_covariance=noise.innovation_covariance)
    truth = np.random.default_rng(4).normal(size=(40, 4))
    N = 3.5
    assert motion.innovation is not None
    assert noise.innovation is not None
    whole = noise._replace(
        state=N * motion.state + noise.state, innovation=N * motion.innovation + noise.innovation
    )
    apart = entries(measures.from_trajectories(motion, noise, truth, 10))
    together = entries(measures.from_trajectories(None, whole, N * truth, 10))
    assert list(apart) == list(together)
    for name, ((mm, mn, nn), _) in apart.items():
        (_, _, value), _ = together[name]
        assert N**2 * mm + 2 * N * mn + nn == pytest.approx(value, rel=1e-11), name


def test_an_estimator_without_covariance_has_no_nees() -> None:
    bare = Trajectory(np.ones((40, 4)), None, None, None)
    names = measures.from_trajectories(None, bare, np.zeros((40, 4)), 10).measures
    assert set(names) == {"x", "y", "vx", "vy", "position", "velocity"}


@pytest.mark.usefixtures("kernels")
def test_a_record_that_is_not_finite_fails_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    config = configure("schemes=[HME1]", "grid.replicates=3")
    ((_, whole),) = run_blocks(config, plan_blocks(config))
    original = batch.sum_errors

    def spoilt(*arguments: Any, **options: Any) -> list[Sums]:
        (sums,) = original(*arguments, **options)
        sums.products[0, 4, 1, 1] = np.inf
        return [sums]

    monkeypatch.setattr(batch, "sum_errors", spoilt)
    ((_, rows),) = run_blocks(config, plan_blocks(config))
    assert rows["replicate"].is_monotonic_increasing
    failed = rows["replicate"] == 1
    assert rows.loc[failed, ["status", "reason"]].to_numpy().tolist() == [
        ["failed", "the estimate is not finite"]
    ]
    others = rows[~failed].reset_index(drop=True)
    pd.testing.assert_frame_equal(
        others, whole[whole["replicate"] != 1].reset_index(drop=True), check_exact=True
    )
