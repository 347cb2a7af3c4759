"""What GNSS adds to white noise, and the filter that finds the antenna's place."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from hanging import QUIET, make, mean_square, run, score

from owtsweep.config import changed
from owtsweep.estimation.inertial.multiplicative import learn_fix
from owtsweep.streams import stream
from owtsweep.studies import compose
from owtsweep.studies.blade.measuring import draw_errors, draw_states
from owtsweep.studies.blade.schemes.mekf import Navigator
from owtsweep.studies.blade.sections import Receiver

DRAWS = partial(stream, 1, "blade", (), 0)
STEP = 0.2
SENSORS = compose(["study=blade"]).sensors


def _draw(count: int = 100_000, **keys: float) -> tuple[np.ndarray, np.ndarray]:
    rate = {"fix_rate": 1.0 / STEP, "vertical": 1.5}
    return draw_errors(changed(SENSORS, receiver=Receiver(**keys), **rate), DRAWS, count)


def test_a_clean_receiver_adds_nothing() -> None:
    errors, floating = _draw()
    assert not errors.any()
    assert not floating.any()


def test_slow_errors_forget_as_their_time_constant_says() -> None:
    errors, _ = _draw(red_sigma=0.02, red_time=10.0)
    assert errors.std(axis=0) == pytest.approx([0.02, 0.02, 0.03], rel=0.05)
    lag = round(10.0 / STEP)
    for column in errors.T:
        alike = np.mean(column[lag:] * column[:-lag]) / np.mean(column**2)
        assert alike == pytest.approx(np.exp(-1.0), abs=0.06)


def test_float_solutions_come_and_go() -> None:
    errors, floating = _draw(fixed_time=60.0, float_time=20.0, float_sigma=0.3)
    assert floating.mean() == pytest.approx(0.25, abs=0.03)
    changes = np.count_nonzero(np.diff(floating.astype(int)) == 1)
    assert changes == pytest.approx(len(floating) * STEP / 80.0, rel=0.1)
    assert not errors[~floating].any()
    assert errors[floating].std(axis=0) == pytest.approx([0.3, 0.3, 0.45], rel=0.15)
    assert not draw_states(Receiver(fixed_time=1e9), DRAWS("float"), 1000, STEP).any()


def test_jumps_last_and_return() -> None:
    errors, floating = _draw(jump_every=50.0, jump_sigma=0.05, jump_time=5.0)
    jumped = errors.any(axis=1)
    assert jumped.mean() == pytest.approx(0.1, abs=0.01)
    assert errors[jumped].std(axis=0) == pytest.approx([0.05, 0.05, 0.075], rel=0.1)
    assert not floating.any()


def test_filters_are_told_of_float_solutions() -> None:
    words = ("sensors.receiver.fixed_time=20", "sensors.receiver.float_time=10")
    _, _, measured, setting = make(*words)
    assert measured.floating[measured.due].any()
    assert setting.float_sigma == pytest.approx(np.hypot(setting.fix_sigma, [0.3, 0.3, 0.50001]))
    deaf = ("tuning=paper", *words)
    for name in ("UKF", "MEKF", "INVARIANT_EKF"):
        assert score(name, *words)["root"] < 0.5 * score(name, *deaf)["root"]


def test_the_antennas_place_in_the_row_of_a_fix() -> None:
    """By differences: what one tight fix changes is along the row that `learn_fix` believes."""
    _, _, measured, setting = make()
    rng, lever = np.random.default_rng(2), np.array([-2.0, 0.5, 1.0])
    found = Navigator(setting, lever=True).filter(measured)
    s = found.states[1000].copy()
    s[16:] = 0.1 * rng.normal(size=3)
    root = rng.normal(size=(18, 18))
    P = root @ root.T

    def predict(dx: np.ndarray) -> np.ndarray:
        """Return where the antenna is after errors dx, by rotation alone."""
        from scipy.spatial.transform import Rotation

        R = Rotation.from_quat(s[6:10], scalar_first=True) * Rotation.from_rotvec(dx[6:9])
        return s[:3] + dx[:3] + R.apply(lever + s[16:] + dx[15:])

    rows = np.stack([
        (predict(1e-6 * each) - predict(-1e-6 * each)) / 2e-6 for each in np.eye(18)
    ]).T  # fmt: skip
    variance, off = np.array([0.3, 0.2, 0.4]), np.array([0.1, -0.2, 0.3])
    fix = predict(np.zeros(18)) + off
    S = rows @ P @ rows.T + np.diag(variance)
    gain = P @ rows.T @ np.linalg.inv(S)
    innovation = fix - predict(np.zeros(18))
    learned, dx = P.copy(), np.zeros(18)
    nis = learn_fix(
        s, learned, dx, fix, lever, variance, -1, 15, measured.specific_force[0], measured.rate[0]
    )
    assert dx == pytest.approx(gain @ innovation, abs=1e-6)
    assert learned == pytest.approx(P - gain @ rows @ P, abs=1e-5)
    assert nis == pytest.approx(innovation @ np.linalg.solve(S, innovation), rel=1e-6)


def test_the_antennas_place_is_found() -> None:
    words = ("grid.lever=[0.1]",)
    lost = [score("MEKF", *words, replicate=replicate) for replicate in range(3)]
    found = [score("MEKF_LEVER", *words, replicate=replicate) for replicate in range(3)]
    assert mean_square(found, "root") < 0.2 * mean_square(lost, "root")
    assert 0.3 < np.mean([each["nees"] for each in found]) < 2.5
    _, motion, measured, setting = make(*QUIET, *words)
    error = run("MEKF_LEVER", setting, measured).root - motion.truth.root
    assert np.abs(error).max() < 1e-4
