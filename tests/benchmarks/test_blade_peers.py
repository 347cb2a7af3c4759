"""Other people's navigation on the same record: filterpy, and 4Subsea's smsfusion.

smsfusion holds a sample over the interval that it begins, ours goes linearly from one to the next.
It gets the means of neighbours, so that both integrate the same; with the samples as they are its
smoother's error is a fifth larger. It takes steps of Euler, so the errors may differ by some per
cent; those of filterpy with our motion may not.
"""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from benchmarks.blade import filter_by_peer
from hanging import make, run
from scipy.spatial.transform import Rotation
from smsfusion import AidedINS, FixedIntervalSmoother

from benchmarks import blade
from owtsweep.arrays import Array
from owtsweep.gravity import GRAVITY
from owtsweep.studies.blade.contract import Measured, Setting
from owtsweep.studies.blade.schemes.navigation import begin

#: A bias that forgets this slowly is a random walk, s.
SLOW = 1e6


def test_filterpy_finds_what_our_unscented_filter_finds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Over 5 s with 25 fixes: a process noise that is off by .1 % would be seen."""
    monkeypatch.setattr(blade, "PEER_STEPS", 250)
    _, _, measured, setting = make()
    assert np.count_nonzero(measured.due[:250]) == 25
    theirs, _ = filter_by_peer(setting, measured)
    ours = run("UKF", setting, measured).root[:250]
    assert np.abs(theirs - ours).max() < 2e-7


def _describe_bias(walk: float) -> dict[str, float]:
    return {"B": walk * np.sqrt(SLOW / 2.0), "tau_cb": SLOW}


def _run_peer(setting: Setting, measured: Measured) -> tuple[Array, Array]:
    """Return roots by smsfusion's filter and by its smoother, shape (steps, 3) each."""
    s, P = begin(setting)
    root = np.sqrt(setting.step)
    peer = AidedINS(
        1.0 / setting.step, s, P,
        {"N": setting.force_sigma * root, **_describe_bias(setting.force_walk)},
        {"N": setting.rate_sigma * root, **_describe_bias(setting.rate_walk)},
        g=GRAVITY, nav_frame="ENU", lever_arm=setting.geometry.levers[0],
        ignore_bias_acc=False, cold_start=False,
    )  # fmt: skip
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # it says that it is experimental
        smoother = FixedIntervalSmoother(peer, cov_smoothing=False)
    force, rate = (
        0.5 * (signal + np.concatenate([signal[1:], signal[-1:]]))
        for signal in (measured.specific_force, measured.rate)
    )
    for k in range(len(rate)):
        fix = measured.fixes[k, 0]
        aid = {} if np.isnan(fix[0]) else {"pos": fix, "pos_var": setting.fix_sigma**2}
        smoother.update(force[k], rate[k], **aid)
    filtered = np.array(smoother._x_buf)
    return _find_root(setting, filtered), _find_root(setting, np.asarray(smoother.x))


def _find_root(setting: Setting, states: Array) -> Array:
    rotation = Rotation.from_quat(states[:, 6:10], scalar_first=True).as_matrix()
    return np.asarray(states[:, :3] + rotation @ setting.geometry.to_root)


@pytest.mark.faults  # slow: its smoother takes 10 s in Python
def test_smsfusion_errs_as_much_as_we_do() -> None:
    config, motion, measured, setting = make("record.duration=50")
    settled = slice(config.record.settled, None)
    for name, theirs in zip(("MEKF", "SMOOTHER"), _run_peer(setting, measured), strict=True):
        ours = run(name, setting, measured).root
        size = [
            np.sqrt(np.mean(np.sum((found - motion.truth.root)[settled] ** 2, axis=1)))
            for found in (ours, theirs)
        ]
        assert size[1] == pytest.approx(size[0], rel=0.06)
