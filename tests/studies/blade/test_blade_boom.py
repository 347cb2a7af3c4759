"""The crane's boom: its truth, its accelerometers, double integration, and the blade beside it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from hanging import QUIET, make, run, score

from owtsweep.estimation.double_integration import pass_high
from owtsweep.gravity import GRAVITY
from owtsweep.studies.base.schemes import Unable
from owtsweep.studies.blade.boom import ENDS, estimate_boom, find_boom_error
from owtsweep.studies.blade.schemes.fixed_gains import merge

STILL = "boom.follow=[0,0,0]"
INNER = slice(400, -400)  # at 20 Hz


def rms(values):
    return np.sqrt(np.mean(np.square(values), axis=0))


def test_the_boom_leaves_other_numbers_as_they_are() -> None:
    """The blade does not notice."""
    _, motion, measured, _ = make()
    other = make("boom.noise=0.01", "boom.bias=1", "boom.modes.aside.sigma=[0.01,0,0]")
    assert np.array_equal(other[1].truth.root, motion.truth.root)
    for name in ("specific_force", "rate", "prisms"):
        assert np.array_equal(getattr(other[2], name), getattr(measured, name))


def test_accelerations_are_derivatives_of_displacements() -> None:
    rate, x, a = make()[1].truth.boom
    assert (rate, x.shape, a.shape) == (200.0, (20000, 3), (20000, 3))
    h = 1.0 / rate
    second = (-x[:-4] + 16 * x[1:-3] - 30 * x[2:-2] + 16 * x[3:-1] - x[4:]) / (12 * h**2)
    assert second == pytest.approx(a[2:-2], abs=2e-5)
    assert rms(a).min() > 0.01


def test_the_tip_moves_in_its_modes_and_follows_the_blade() -> None:
    config, motion, _, _ = make(STILL, short=False)
    sizes = rms(motion.truth.boom.position)
    modes = [np.square(mode.sigma) for mode in config.boom.modes.values()]
    assert sizes == pytest.approx(np.sqrt(np.sum(modes, axis=0)), rel=0.2)
    both = make(short=False)[1]
    followed = (both.truth.boom.position - motion.truth.boom.position)[::4]
    swing = both.series.position[both.lead :, :3]
    assert followed == pytest.approx([0.01, 0.02, 0.3] * swing, abs=1e-12)


def test_accelerometers_feel_gravity_bias_and_noise() -> None:
    _, motion, measured, _ = make()
    error = measured.boom.values - motion.truth.boom.acceleration - [0.0, 0.0, GRAVITY]
    assert error.std(axis=0) == pytest.approx([1.2e-4] * 3, rel=0.03)
    assert 0.0 < np.abs(error.mean(axis=0)).max() < 0.2


def test_double_integration_finds_the_vibration() -> None:
    """Within .2 mm in both directions; in one, the error is of the size of the motion."""
    _, motion, measured, setting = make(short=False)
    boom = motion.truth.boom
    estimate = run("DOUBLE_INTEGRATION", setting, measured).boom
    true = pass_high(boom.position[::10], 20.0)
    assert rms((estimate - true)[INNER]).max() < 0.2e-3
    together = np.linalg.norm(rms((estimate - true)[INNER]))
    assert find_boom_error(boom, estimate, 0.0) == pytest.approx(together)
    assert together < 0.2e-3
    causal = estimate_boom(measured.boom, zero_phase=False)
    lead = rms((causal - true)[INNER]) / rms(true[INNER])
    assert np.all((lead > 0.4) & (lead < 1.8))
    assert find_boom_error(boom, estimate, 280.0) is None
    assert find_boom_error(boom, estimate, 200.0) < 0.2e-3
    assert ENDS == 20.0


def test_the_measure_is_reported() -> None:
    assert score("DOUBLE_INTEGRATION")["boom"] < 0.2e-3
    assert "boom" not in score("HOLD")


def test_both_parts_of_the_blades_motion_add_up() -> None:
    """Slow and fast sines come out, the slow one by fixes alone, the fast one by accelerations."""
    time = np.arange(15000) / 50.0
    inner = slice(1500, -1500)
    for frequency, wrong in ((0.05, 0), (1.0, 1)):
        w = 2 * np.pi * frequency
        x = np.sin(w * time + 0.3)[:, None] * [1.0, 2.0, 3.0]
        parts = [-(w**2) * x, x[::10]]
        at = np.arange(0, 15000, 10)
        for gone in (None, wrong):
            told = [part * (0.0 if i == gone else 1.0) for i, part in enumerate(parts)]
            found = merge(told[0], 0.02, at, told[1])
            assert np.abs(found - x)[inner].max() < 0.012 * 3


def test_the_root_is_found_away_from_the_ends() -> None:
    _, motion, measured, setting = make(*QUIET, short=False)
    found = run("DOUBLE_INTEGRATION", setting, measured)
    error = (found.root - motion.truth.root)[2000:-2000]
    # what is left is the interpolation of fixes and the ripple
    assert rms(error).max() < 1e-3
    assert found.latency == pytest.approx(300.0)
    speed = (found.root_velocity - motion.truth.root_velocity)[2000:-2000]
    assert rms(speed).max() < 2e-3


def test_it_takes_most_of_the_noise_of_fixes_away() -> None:
    """Below .15 of 2.5 Hz a sixteenth of the variance is left; of UKF's, more."""
    chain, filtered = (score(name, short=False) for name in ("DOUBLE_INTEGRATION", "UKF"))
    assert chain["root"] < filtered["root"]


def test_it_says_what_it_cannot_do() -> None:
    _, _, measured, setting = make()
    lost = replace(measured, fixes=np.full_like(measured.fixes, np.nan))
    with pytest.raises(Unable, match="no fix"):
        run("DOUBLE_INTEGRATION", setting, lost)
    short = replace(
        measured, rate=measured.rate[:400], specific_force=measured.specific_force[:400],
        fixes=measured.fixes[:400], due=measured.due[:400],
    )  # fmt: skip
    with pytest.raises(Unable, match="more than 10 s"):
        run("DOUBLE_INTEGRATION", setting, short)
    assert run("DOUBLE_INTEGRATION", setting, replace(measured, boom=None)).boom is None
