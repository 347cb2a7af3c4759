"""The kernels, many lanes at a time in chunks, against the algorithms in plain NumPy.

One step after the other, one operation after the other, whole matrices: nothing is shared with the
kernels but the gains.
"""

from __future__ import annotations

import numpy as np
import pytest
from tools import Array, assert_same, configure

from owtsweep.studies.hub import batch, estimates
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.contract import Known, resolve
from owtsweep.studies.hub.records import Records, make_records

pytestmark = pytest.mark.usefixtures("kernels")

AMPLITUDE = 0.7


def positions(chain: Chain, force: Array, fixes: Array, arrival: Array | None, q: int) -> Array:
    """What the filter takes at the steps of fix interval q, (M, lanes), of the MHE's maps."""
    mhe, M, delay = chain.mhe, chain.filter.fix_interval, chain.filter.input_delay
    T, lanes = mhe.step, force.shape[1]

    def inputs(k: int) -> Array:
        """What the MHE integrates over step k."""

        def at(step: int) -> Array:
            return force[step - delay] if step >= delay else np.zeros(lanes)

        if mhe.inputs == 0:
            return at(k)
        tick = k // mhe.interval * mhe.interval
        if mhe.inputs == 2:
            return at(tick)
        return sum(at(j) for j in range(tick - mhe.interval + 1, tick + 1)) / mhe.interval

    def effect(first: int, stop: int) -> Array:
        p, v = np.zeros(lanes), np.zeros(lanes)
        for k in range(first, stop):
            p, v = p + T * v + T**2 / 2 * inputs(k), v + T * inputs(k)
        return np.array([p, v, np.zeros(lanes)])

    if q < mhe.first:
        return np.repeat(fixes[q][None], M, axis=0)
    n = min(q, mhe.horizon)
    known = [*fixes[q - n : q + 1]]
    for j in range(q - n, q):
        known += [*effect(j * M, (j + 1) * M)]
    if mhe.arrival and q >= mhe.horizon:
        assert arrival is not None
        known += [*arrival]
    node = mhe.maps[min(q, len(mhe.maps) - 1)][:, : len(known)] @ np.array(known)
    result = np.empty((M, lanes))
    for i in range(M):
        tick = i // mhe.interval * mhe.interval
        t = tick * T
        moved = node[0] + t * node[1] + t**2 / 2 * node[2]
        result[i] = moved + effect(q * M, q * M + tick)[0]
    return result


def plain(chain: Chain, force: Array, fixes: Array) -> tuple[Array, Array, Array]:
    """Estimates of position and velocity and the innovation, (steps, lanes) each."""
    arrays, gains, window = chain.filter, chain.gains, chain.filter.window
    steps, lanes = force.shape
    M, delay = arrays.fix_interval, arrays.input_delay
    H = np.array([[1.0, 0.0, 0.0, 0.0], arrays.h])
    x = np.zeros((4, lanes))
    X, e = np.zeros((steps, 4, lanes)), np.zeros((steps, 4, lanes))
    innovation = np.full((steps, lanes), np.nan)
    nothing = np.zeros(lanes)
    for k in range(steps):
        q = k // M
        now = force[k - delay] if k >= delay else nothing
        before = force[k - delay - 1] if k > delay else nothing
        if k % M == 0:
            taken = np.repeat(fixes[q][None], M, axis=0)
            if chain.mhe.active:
                old = (q - chain.mhe.horizon) * M
                taken = positions(chain, force, fixes, X[old][[0, 1, 3]] if old >= 0 else None, q)
        row = int(gains.row(k))
        predicted = arrays.A @ x + np.outer(arrays.B, before)
        z = np.array([taken[k % M], now]) - H @ predicted
        if gains.applied[row]:
            innovation[k] = z[0]
        else:
            z[0] = 0.0
        e[k] = gains.K[row] @ z
        x = X[k] = predicted + e[k]
    state = np.zeros((steps, 4, lanes))
    for k in range(window, steps):
        state[k], product = X[k - window], np.eye(4)
        for j in range(k - window, k):
            product = product @ arrays.C[gains.row(j)]
            state[k] = state[k] + product @ e[j + 1]
    p, v, b = state[:, 0], state[:, 1], state[:, 3]
    predictor = chain.predictor
    if predictor.steps:
        model = chain.input_model
        assert model is not None
        for k in range(steps):
            y = np.array([p[k], v[k], b[k]])
            for j in range(k - predictor.steps, k):
                y = model.A @ y + np.outer(model.B[:, 0], force[j] if j >= 0 else nothing)
            p[k], v[k] = y[0], y[1]
    return p, v, innovation


def squares(chain: Chain, records: Records, settled: int) -> Array:
    """Sums of squared errors of whole series, (2 windows, 6 quantities, replicates)."""
    p, v, innovation = plain(chain, *records.measure(AMPLITUDE))
    replicates = len(records.replicates)
    truth = [
        AMPLITUDE * np.array([getattr(m, name) for m in records.motion])[:, None]
        * records.direction[:, None]
        for name in ("position", "velocity")
    ]  # fmt: skip
    rows = chain.gains.row(np.arange(len(p)))
    result = np.zeros((2, 6, replicates))
    for r in range(replicates):
        ep, ev = p[:, 2 * r : 2 * r + 2] - truth[0][r].T, v[:, 2 * r : 2 * r + 2] - truth[1][r].T
        error = np.stack([ep, ev], axis=2)
        nees = np.einsum("kai,kij,kaj->k", error, np.linalg.inv(chain.covariance[rows]), error)
        nis = np.sum(innovation[:, 2 * r : 2 * r + 2] ** 2, axis=1)
        nis = np.where(chain.gains.fresh[rows], nis / chain.gains.innovation_variance[rows], 0.0)
        each = np.array([ep[:, 0] ** 2, ep[:, 1] ** 2, ev[:, 0] ** 2, ev[:, 1] ** 2, nees, nis])
        result[:, :, r] = each[:, :settled].sum(axis=1), each[:, settled:].sum(axis=1)
    return result


@pytest.mark.parametrize("name", ["EKF", "MKF", "HME1", "HME2"])
@pytest.mark.parametrize(
    ("tuning", "changes"),
    [
        ("matched", ("hme.mhe.inputs=sampled",)),
        ("paper", ("sensors.gnss.delay=0.65", "hme.smoother_window=8")),
        # ticks that chunks of 500 steps cut through
        (
            "paper",
            (
                "sensors.gnss.rate=1.25",
                "hme.mhe.interval=0.8",
                "hme2.update_rule=mask_rows",
                "hme2.r_gnss.scale=100",
            ),
        ),
    ],
)
def test_kernels_are_the_algorithms(name: str, tuning: str, changes: tuple[str, ...]) -> None:
    config = configure(*changes, tuning=tuning)
    records = make_records(config, 4.0, range(2))
    assert records.steps > batch.CHUNK
    chain = resolve(name).kernel(Known(records.sensors, config), records.steps)
    force, fixes = records.measure(AMPLITUDE)
    found = estimates.trajectories(chain, force, fixes)
    expected = plain(chain, force, fixes)
    for what, ours, theirs in zip(("position", "velocity"), found, expected, strict=False):
        assert_same(ours, theirs, what)
    fresh = chain.gains.fresh[chain.gains.row(np.arange(records.steps))]
    assert_same(found[2][fresh], expected[2][fresh], "innovation")
    sums = batch.sum_errors([chain], records, 130, AMPLITUDE)[0].products
    np.testing.assert_allclose(sums[:, :, 2], squares(chain, records, 130), rtol=1e-9)


@pytest.mark.parametrize("steps", [1, 30, 41, batch.CHUNK + 1, batch.CHUNK + 30])
def test_chunks_that_are_shorter_than_the_smoothers_window(steps: int) -> None:
    config = configure("hme.smoother_window=40", tuning="paper")
    records = make_records(config, 4.0, range(1))
    chain = resolve("HME1").kernel_for_runs(Known(records.sensors, config), records.steps)
    assert chain.filter.window == 40
    force, fixes = records.measure(AMPLITUDE)
    found = estimates.trajectories(chain, force[:steps], fixes)
    expected = plain(chain, force[:steps], fixes)
    for what, ours, theirs in zip(("position", "velocity"), found, expected, strict=False):
        assert_same(ours, theirs, what)
