"""The loop over `update`, with estimators that are written down here."""

from __future__ import annotations

import numpy as np
import pytest

from owtsweep.evaluation.estimate import Estimate, Innovation
from owtsweep.evaluation.loop import RecordEstimator, run_estimator, run_steps
from owtsweep.evaluation.trajectory import Trajectory


class Recorder:
    """Estimates the last fix and the sum of the forces; has a covariance at fixes alone."""

    def __init__(self) -> None:
        self.velocity, self.position, self.calls = np.zeros(2), np.zeros(2), 0

    def update(self, specific_force, position=None):
        self.calls += 1
        self.velocity = self.velocity + specific_force
        if position is None:
            return Estimate(self.position, self.velocity)
        innovation = Innovation(position - self.position, 4.0 * np.eye(2))
        self.position = position
        return Estimate(self.position, self.velocity, np.diag([1.0, 4.0, 9.0, 16.0]), innovation)


def make_record(steps=20, interval=5):
    draw = np.random.default_rng(1)
    return draw.normal(size=(steps, 2)), draw.normal(size=(-(-steps // interval), 2)), interval


def test_a_fix_comes_at_every_interval_unless_it_is_nan():
    force, fixes, interval = make_record()
    fixes[2] = np.nan
    run = run_estimator(Recorder(), force, fixes, interval)
    assert np.array_equal(run.state[4, :2], fixes[0])
    assert np.array_equal(run.state[10, :2], fixes[1])
    assert np.array_equal(run.state[15, :2], fixes[3])
    assert np.allclose(run.state[:, 2:], np.cumsum(force, axis=0))
    assert run.innovation is not None
    assert run.covariance is not None
    at = np.flatnonzero(np.isfinite(run.innovation[:, 0]))
    assert at.tolist() == [0, 5, 15]
    assert np.array_equal(run.innovation[15], fixes[3] - fixes[1])
    assert np.array_equal(np.flatnonzero(np.isfinite(run.covariance[:, 0, 0])), at)
    assert np.array_equal(run.deviation[5], [1.0, 2.0, 3.0, 4.0])


def test_pieces_of_a_run_are_the_run():
    force, fixes, interval = make_record()
    whole = run_estimator(Recorder(), force, fixes, interval)
    positions = np.full((20, 2), np.nan)
    positions[::interval] = fixes
    estimator = Recorder()
    pieces = [run_steps(estimator, force[p], positions[p]) for p in (slice(0, 7), slice(7, 20))]
    assert np.array_equal(np.concatenate([piece.state for piece in pieces]), whole.state)


def test_what_offers_a_record_at_once_is_asked_for_it():
    force, fixes, interval = make_record()

    class AtOnce(Recorder, RecordEstimator):
        def run_record(self, specific_force, positions):
            assert np.array_equal(positions[::interval], fixes)
            assert np.isnan(positions).any(axis=1).sum() == 16
            return Trajectory(np.zeros((len(specific_force), 4)))

    estimator = AtOnce()
    run = run_estimator(estimator, force, fixes, interval)
    assert estimator.calls == 0
    assert run.covariance is None
    assert np.isnan(run.deviation).all()


@pytest.mark.parametrize(
    ("estimate", "error", "words"),
    [
        (None, TypeError, "update gave a NoneType, not an owtsweep.Estimate"),
        (Estimate(np.zeros(3), np.zeros(2)), ValueError, r"position of step 30 has the shape \(3,"),
        (Estimate(np.zeros(2), 0.0), ValueError, r"velocity of step 30 has the shape \(\), not"),
        (Estimate(np.zeros(2), np.array([0.0, np.inf])), ValueError, "step 30 is not finite"),
    ],
)
def test_a_bad_estimate_is_refused_with_its_step(estimate, error, words):
    class Bad:
        def update(self, specific_force, position=None):
            return estimate

    with pytest.raises(error, match=words):
        run_steps(Bad(), np.zeros((2, 2)), np.full((2, 2), np.nan), first=30)


def test_a_record_at_once_must_be_finite_too():
    class Lost(RecordEstimator):
        def update(self, specific_force, position=None):
            raise NotImplementedError

        def run_record(self, specific_force, positions):
            state = np.zeros((len(specific_force), 4))
            state[3:] = np.nan
            return Trajectory(state)

    with pytest.raises(ValueError, match="the estimate of step 13 is not finite"):
        run_steps(Lost(), np.zeros((5, 2)), np.full((5, 2), np.nan), first=10)


def test_an_estimator_of_other_quantities_is_refused():
    class Tower:
        def update(self, inputs, fix=None):
            return Estimate(tilt=inputs[:1], strain=inputs[1:])

    with pytest.raises(ValueError, match="the estimate of step 0 has no position"):
        run_estimator(Tower(), np.zeros((8, 4)), np.zeros((2, 3)), 4)
