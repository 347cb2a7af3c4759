"""What the floater's sensors say: noise, bias, delay, losses, timing; and what schemes are told."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from itertools import groupby

import numpy as np
import pytest

from owtsweep.studies import compose
from owtsweep.studies.floater.contract import DOF
from owtsweep.studies.floater.declaration import make_setting
from owtsweep.studies.floater.measuring import find_sigmas, measure
from owtsweep.studies.floater.truth import make_truth

SHORT = ("study=floater", "record.duration=250", "record.settling=10", "grid.delay=[0,20]")
#: So little noise that it does not count.
QUIET = 400.0
STEP = 0.05


@cache
def configure(*words):
    return compose([*SHORT, *words])


@cache
def move(*words, replicate=0):
    return make_truth(configure(*words), replicate)


def sense(*words, replicate=0, delay=0.0, bias=0.0, snr=20.0, loss=0.0):
    """Return what sensors say of record 0, by the draws of a replicate."""
    cell = {"delay": delay, "bias": bias, "snr": snr, "loss": loss, "believed": 1.0}
    return measure(configure(*words), replace(move(*words), replicate=replicate), cell)


def tell(*words, delay=0.0, bias=0.0, snr=20.0, believed=1.0):
    """Return what schemes are told."""
    cell = {"delay": delay, "bias": bias, "snr": snr, "loss": 0.0, "believed": believed}
    return make_setting(configure(*words), move(*words), cell)


def errors(measured, motion):
    """Return the noise of positions, rates and accelerations without delay and bias."""
    truth = motion.truth
    return (
        measured.position - truth.position,
        measured.rate - truth.velocity[:, 3:],
        measured.acceleration - truth.acceleration,
    )


def test_noise_has_the_ratio_to_the_variance_or_to_the_mean_square() -> None:
    truth = move().truth
    signals = (truth.position, truth.velocity[:, 3:], truth.acceleration)
    for noise, signal in zip(errors(sense(snr=20.0), move()), signals, strict=True):
        assert noise.std(axis=0) == pytest.approx(0.1 * signal.std(axis=0), rel=0.05)
        assert np.abs(noise.mean(axis=0) / noise.std(axis=0)).max() < 0.06
        # White: no sample knows the one before.
        before, after = noise[:-1] / noise.std(axis=0), noise[1:] / noise.std(axis=0)
        assert np.abs((before * after).mean(axis=0)).max() < 0.06
    position, *others = errors(sense("sensors.power=square"), move("sensors.power=square"))
    wanted = 0.1 * np.sqrt(np.mean(truth.position**2, axis=0))
    assert wanted[0] > 0.2 * truth.position[:, 0].std()  # the mean of surge counts
    assert position.std(axis=0) == pytest.approx(wanted, rel=0.05)
    for noise, signal in zip(others, signals[1:], strict=True):
        assert noise.std(axis=0) == pytest.approx(0.1 * signal.std(axis=0), rel=0.05)


def test_noise_of_positions_may_be_given_in_metres_and_degrees() -> None:
    word = "sensors.sigma=[0.01,0.02,0.03,0.1,0.2,0.3]"
    wanted = np.array([0.01, 0.02, 0.03, *np.deg2rad([0.1, 0.2, 0.3])])
    position, rate, _ = errors(sense(word), move(word))
    assert position.std(axis=0) == pytest.approx(wanted, rel=0.05)
    assert np.array_equal(rate, errors(sense(), move())[1])
    assert tell(word).position_sigma == pytest.approx(wanted)


def test_exact_inertial_leaves_rates_noisy() -> None:
    word = "sensors.exact_inertial=true"
    plain, exact = errors(sense(), move()), errors(sense(word), move(word))
    assert not exact[2].any()
    assert np.array_equal(plain[0], exact[0])
    assert np.array_equal(plain[1], exact[1])


def test_more_noise_is_the_same_draws_enlarged() -> None:
    small, large = errors(sense(snr=30.0), move()), errors(sense(snr=10.0), move())
    for one, ten in zip(small, large, strict=True):
        assert ten == pytest.approx(10.0 * one, rel=1e-9, abs=1e-12)
    flat = np.column_stack([*large, *errors(sense(snr=10.0, replicate=1), move())])
    assert np.abs(np.corrcoef(flat.T) - np.eye(30)).max() < 0.07
    # No sensor has the draws of another one.
    told = tell("tuning=matched", snr=10.0)
    sigmas = (told.position_sigma, told.rate_sigma, told.acceleration_sigma)
    drawn = [np.round(e / s, 6).ravel()[:6] for e, s in zip(large, sigmas, strict=True)]
    assert len(set(np.concatenate(drawn))) == 18
    # Delay, losses and bias leave them as they are.
    plain, other = sense(), sense(delay=3.0, loss=0.2, bias=0.1)
    assert np.array_equal(plain.rate, other.rate)
    seen = ~other.lost[3:]
    noise = (other.position[3:] - move().truth.position[:-3])[seen]
    assert noise == pytest.approx(errors(plain, move())[0][3:][seen], abs=1e-12)


def test_a_bias_has_its_size_in_each_acceleration_and_a_random_sign() -> None:
    size = move().truth.acceleration.std(axis=0)
    signs = []
    for replicate in range(12):
        plain, biased = (sense(bias=bias, replicate=replicate) for bias in (0.0, 0.3))
        added = (biased.acceleration - plain.acceleration) / size
        assert np.abs(added) == pytest.approx(0.3, abs=1e-9)
        assert not np.ptp(added, axis=0).any() or np.ptp(added, axis=0).max() < 1e-9
        signs.append(np.sign(added[0]))
    assert np.abs(np.mean(signs)) < 0.35
    assert (np.ptp(signs, axis=0) == 2.0).all()


def test_a_drifting_bias_has_moved_by_its_size_after_100_s() -> None:
    word = "sensors.bias_drift=0.5"
    size = move().truth.acceleration.std(axis=0)
    moved = []
    for replicate in range(100):
        steady, drifting = sense(replicate=replicate), sense(word, replicate=replicate)
        walk = (drifting.acceleration - steady.acceleration) / size
        moved.append([walk[2000] - walk[0], walk[4000] - walk[0], walk[1] - walk[0]])
    spread = np.sqrt(np.mean(np.square(moved), axis=(0, 2)))
    assert spread == pytest.approx(0.5 * np.array([1.0, np.sqrt(2.0), 1 / np.sqrt(2000)]), rel=0.12)
    told = tell(word, "tuning=matched").bias_walk * np.sqrt(100.0)
    assert told == pytest.approx(0.5 * size)


@pytest.mark.parametrize("delay", [0.0, 1.0, 7.0, 2.5, 0.3])
def test_a_report_shows_the_motion_of_delay_ago(delay: float) -> None:
    """Also between samples: against the decay's closed form; linear interpolation would be off."""
    words = ("motion=decay", "record.duration=20", "sensors.frame=global")
    config, motion = configure(*words), move(*words)
    measured = sense(*words, delay=delay, snr=QUIET)
    step = measured.step
    assert measured.age == pytest.approx(delay * step)
    time = step * np.arange(len(measured.position)) - delay * step
    for column, name in enumerate(DOF):
        freedom = config.motion.freedoms[name]
        size = freedom.resonance.sigma * (1.0 if column < 3 else np.pi / 180.0)
        zeta, natural = freedom.resonance.damping, 2.0 * np.pi / freedom.resonance.period
        damped = natural * np.sqrt(1.0 - zeta**2)
        shape = np.cos(damped * time) + zeta * natural / damped * np.sin(damped * time)
        wanted = size * np.where(time > 0.0, np.exp(-zeta * natural * time) * shape, 1.0)
        later = time >= 0.0  # the step across the release has a jump of acceleration
        assert measured.position[later, column] == pytest.approx(wanted[later], abs=1e-11 * size)
        assert measured.position[:, column] == pytest.approx(wanted, abs=1e-3 * size)
    if delay == 2.5:
        halfway = 0.5 * (motion.truth.position[:-1] + motion.truth.position[1:])
        assert np.abs(halfway[:-2] - measured.position[3:]).max() > 1e-6


def test_random_losses_have_their_share_and_length() -> None:
    for zeros in (True, False):
        word = f"sensors.lost_as={'zeros' if zeros else 'missing'}"
        drawn = [sense(word, loss=0.2, replicate=i) for i in range(40)]
        assert np.mean([each.lost for each in drawn]) == pytest.approx(0.2, abs=0.015)
        for each in drawn:
            at_loss = each.position[each.lost]
            assert not at_loss.any() if zeros else np.isnan(at_loss).all()
            assert np.isfinite(each.position[~each.lost]).all()
        # .5 s at 20 Hz; outages may overlap, and the record's end cuts the last one.
        runs = [[len(list(run)) for lost, run in groupby(each.lost) if lost][:-1] for each in drawn]
        assert min(min(each) for each in runs) == 10
        assert max(max(each) for each in runs) > 10
    few, many = sense(loss=0.05), sense(loss=0.2)
    assert few.lost.sum() < many.lost.sum()
    assert not (few.lost & ~many.lost).any()
    assert not sense(loss=0.0).lost.any()


def test_losses_may_come_at_given_times_as_in_the_paper() -> None:
    """Every 100 s ten samples (Fig. 6), whatever the share is."""
    word = "sensors.loss_every=100"
    lost = sense(word).lost
    assert np.array_equal(np.flatnonzero(lost), [*range(2000, 2010), *range(4000, 4010)])
    assert np.array_equal(sense(word, replicate=3).lost, lost)


def test_a_slower_optical_system_reports_at_some_samples() -> None:
    measured = sense("sensors.optical_rate=8", snr=QUIET, loss=0.3)
    due = np.isfinite(measured.position).all(axis=1)
    places = np.flatnonzero(due)
    assert due.sum() == pytest.approx(8 * 250, abs=1)
    assert set(np.diff(places)) == {2, 3}
    assert places[0] == 0
    # A sample without a report is no loss and shows no zeros.
    assert not measured.lost[~due].any()
    assert not measured.position[measured.lost].any()
    seen = due & ~measured.lost
    assert measured.position[seen] == pytest.approx(move().truth.position[seen], abs=1e-12)
    assert np.isfinite(sense("sensors.optical_rate=20").position).all()
    fourth = np.isfinite(sense("sensors.optical_rate=5").position[:, 0])
    assert np.array_equal(np.flatnonzero(fourth), np.arange(0, 5000, 4))


def test_irregular_reports_tell_their_own_time() -> None:
    measured = sense("sensors.jitter=0.2", delay=5.0, snr=QUIET)
    age = measured.age / STEP
    assert age.mean() == pytest.approx(5.0, abs=0.02)
    assert age.std() == pytest.approx(0.2, rel=0.05)
    shown = move().at(STEP * np.arange(5000) - measured.age)
    assert measured.position == pytest.approx(shown, abs=1e-12)


def test_sensors_are_in_the_basins_frame_or_fixed_to_the_body() -> None:
    truth = move().truth
    fixed, free = sense("sensors.frame=body", snr=QUIET), sense(snr=QUIET)
    assert fixed.acceleration is None
    assert free.specific_force is None
    assert fixed.specific_force == pytest.approx(truth.specific_force, abs=1e-12)
    assert fixed.rate == pytest.approx(truth.rate, abs=1e-12)
    assert free.acceleration == pytest.approx(truth.acceleration, abs=1e-12)
    assert free.rate == pytest.approx(truth.velocity[:, 3:], abs=1e-12)
    assert np.abs(truth.rate - truth.velocity[:, 3:]).max() > 1e-5
    # Noise and bias refer to what moves, not to gravity.
    noisy, biased = (sense("sensors.frame=body", bias=bias) for bias in (0.0, 0.1))
    size = truth.acceleration[:, :3].std(axis=0)
    noise = noisy.specific_force - truth.specific_force
    assert noise.std(axis=0) == pytest.approx(0.1 * size, rel=0.05)
    added = biased.specific_force - noisy.specific_force
    assert np.abs(added[0]) == pytest.approx(0.1 * size)


def test_believed_noise_is_the_sensors_own_and_r_is_a_variance() -> None:
    truth, setting = move().truth, tell(snr=10.0)
    share = 10.0**-0.5
    assert setting.position_sigma == pytest.approx(share * truth.position.std(axis=0))
    assert setting.rate_sigma == pytest.approx(share * truth.velocity[:, 3:].std(axis=0))
    wrong = tell(snr=10.0, believed=100.0)
    assert wrong.position_sigma == pytest.approx(10.0 * setting.position_sigma)
    assert wrong.rate_sigma == pytest.approx(10.0 * setting.rate_sigma)
    assert np.array_equal(wrong.acceleration_sigma, setting.acceleration_sigma)
    moved = [truth.position.std(axis=0), truth.velocity.std(axis=0), truth.acceleration.std(axis=0)]
    assert setting.motion_sigma == pytest.approx(np.stack(moved))
    periods = [configure().motion.freedoms[name].resonance.period for name in DOF]
    assert setting.frequency == pytest.approx(2.0 * np.pi / np.array(periods))


def test_process_bias_and_delay_are_the_truth_or_what_is_declared() -> None:
    size = move().truth.acceleration.std(axis=0)
    case = {"snr": 40.0, "bias": 0.2, "delay": 3.0}
    truth = tell("tuning=matched", **case)
    assert truth.acceleration_sigma == pytest.approx(0.01 * size)
    assert truth.bias_sigma == pytest.approx(0.2 * size)
    assert truth.delay == pytest.approx(3.0 * STEP)
    paper = tell("tuning=paper", "filters.process_share=0.07", "filters.bias_share=0.04", **case)
    assert paper.acceleration_sigma == pytest.approx(0.07 * size)
    assert paper.bias_sigma == pytest.approx(0.04 * size)
    assert not paper.bias_walk.any()
    assert paper.delay == 0.0
    words = ("filters.delay=declared", "filters.delay_declared=0.025")
    assert tell(*words, **case).delay == 0.025
    assert paper.zeros
    assert not tell("sensors.lost_as=missing").zeros
    exact = tell("tuning=matched", "sensors.exact_inertial=true")
    assert not exact.acceleration_sigma.any()


def test_with_body_fixed_sensors_angular_accelerations_are_noise_themselves() -> None:
    truth = move().truth
    setting = tell("tuning=matched", "sensors.frame=body", "sensors.bias_drift=0.1", bias=0.2)
    size = truth.acceleration[:, :3].std(axis=0)
    assert setting.body
    assert setting.acceleration_sigma[:3] == pytest.approx(0.1 * size)
    angular = truth.acceleration[:, 3:].std(axis=0)
    assert setting.acceleration_sigma[3:] == pytest.approx(2.0 * angular)
    assert setting.bias_sigma == pytest.approx([*(0.2 * size), 0.0, 0.0, 0.0])
    assert setting.bias_walk == pytest.approx([*(0.01 * size), 0.0, 0.0, 0.0])


def test_no_report_shows_the_future() -> None:
    ages = sense("sensors.jitter=1").age
    assert ages.min() == 0.0
    assert np.median(ages) == pytest.approx(0.0, abs=0.1 * STEP)
    assert ages.max() > STEP


def test_an_accelerometer_that_leans_is_no_noisier() -> None:
    """Its noise and bias refer to the motion, not to the gravity that a roll lets in."""
    words = ("sensors.frame=body",)
    motion = make_truth(configure(*words), 0, 20.0)
    gravity = motion.truth.specific_force.std(axis=0)
    noise = find_sigmas(configure(*words), motion, 20.0).acceleration
    assert noise == pytest.approx(0.1 * motion.truth.acceleration[:, :3].std(axis=0))
    assert gravity[1] > 3.0 * motion.truth.acceleration[:, 1].std()
