"""Double integration: known sines, the paper's gains, and a boom's motion through the chain."""

import numpy as np
import pytest
from scipy import signal as reference

from owtsweep.errors import InputError
from owtsweep.estimation.double_integration import decimate, integrate_twice, pass_high

RECORDED, RATE, DURATION = 200.0, 20.0, 300.0
#: 20 s from both ends.
INSIDE = slice(400, -400)


def rms(values):
    return np.sqrt(np.mean(values[INSIDE] ** 2))


def swing(frequency, rate=RATE, duration=DURATION):
    return np.sin(2 * np.pi * frequency * np.arange(round(duration * rate)) / rate + 0.4)


def make_boom(seed):
    """Return a boom's displacement at 20 Hz, m, and its acceleration at 200 Hz, three axes.

    Four sines of 1 to 4 mm between .3 and 2 Hz; noise of the GMS-18 (Table 1) and a bias.
    """
    rng = np.random.default_rng(seed)
    t = np.arange(round(DURATION * RECORDED)) / RECORDED
    x, a = np.zeros((2, len(t), 3))
    for axis in range(3):
        for _ in range(4):
            w, phase = 2 * np.pi * rng.uniform(0.3, 2.0), rng.uniform(0.0, 2 * np.pi)
            size = rng.uniform(0.001, 0.004)
            x[:, axis] += size * np.sin(w * t + phase)
            a[:, axis] -= size * w**2 * np.sin(w * t + phase)
    a += rng.normal(scale=1.2e-4, size=a.shape) + np.array([0.05, -0.02, 0.1])
    return x[::10], a


def test_decimation_is_that_of_scipy():
    values = np.random.default_rng(1).normal(size=(5000, 2))
    expected = reference.decimate(values, 10, n=8, ftype="iir", axis=0, zero_phase=True)
    assert np.array_equal(decimate(values, RECORDED), expected)
    assert np.allclose(decimate(values[:, 1], RECORDED), expected[:, 1], rtol=0, atol=1e-12)
    assert np.array_equal(decimate(values, RATE), values)


def test_decimation_delays_nothing_and_lets_nothing_fold():
    sent = swing(1.0, RECORDED)
    got = decimate(sent, RECORDED)[INSIDE]
    assert np.abs(got - sent[::10][INSIDE]).max() < 0.012  # ripple, .05 dB twice
    # 19 Hz would fold to 1 Hz
    assert np.abs(decimate(swing(19.0, RECORDED), RECORDED)[INSIDE]).max() < 1e-6


def test_integration_of_whole_periods_is_exact():
    for frequency in (0.1, 0.5, 2.0):  # whole periods in 300 s
        w = 2 * np.pi * frequency
        x = swing(frequency)
        assert np.allclose(integrate_twice(-(w**2) * x + 0.3, RATE), x, rtol=0, atol=1e-9)


def test_integration_of_odd_records_and_many_axes():
    t = np.arange(101) / RATE
    w = 2 * np.pi * 3 / (101 / RATE)
    both = np.column_stack([np.sin(w * t), np.cos(w * t)])
    assert np.allclose(integrate_twice(-(w**2) * both, RATE), both, rtol=0, atol=1e-12)


def test_what_is_no_period_differs_by_a_parabola():
    """The velocity gained over the record goes into the mean acceleration, which is removed."""
    t = np.arange(6000) / RATE
    x = swing(0.517)
    found = integrate_twice(-((2 * np.pi * 0.517) ** 2) * x, RATE)
    left = found - x
    assert np.ptp(left) > 0.5
    assert rms(left - np.polyval(np.polyfit(t, left, 2), t)) < 3e-3
    assert rms(pass_high(left, RATE)) < 5e-4


def test_high_pass_gains_are_those_of_the_design():
    sections = reference.cheby1(5, 0.01, 0.15, btype="highpass", output="sos", fs=RATE)
    for frequency in (0.075, 0.1, 0.2, 0.3, 1.0, 2.0):
        (gain,) = np.abs(reference.sosfreqz(sections, [frequency], fs=RATE)[1])
        sent = swing(frequency, duration=600.0)
        for zero_phase, power in ((True, 2), (False, 1)):
            got = pass_high(sent, RATE, zero_phase=zero_phase)[1200:-1200]
            found = np.sqrt(np.mean(got**2) / np.mean(sent[1200:-1200] ** 2))
            assert abs(found - gain**power) < 2e-3


def test_high_pass_removes_a_swinging_load():
    """At .075 Hz 99.67 % goes in both directions, 94 % in one; at .1 Hz 90 and 68 %."""
    sent = swing(0.075)
    assert rms(pass_high(sent, RATE)) < 0.01 * rms(sent)
    assert rms(pass_high(sent, RATE)) == pytest.approx(0.0033 * rms(sent), rel=0.1)
    assert rms(pass_high(sent, RATE, zero_phase=False)) == pytest.approx(0.057 * rms(sent), rel=0.1)
    assert rms(pass_high(swing(0.1), RATE)) == pytest.approx(0.103 * rms(sent), rel=0.02)


def test_high_pass_removes_a_mean_from_the_first_sample_on():
    for zero_phase in (True, False):
        left = pass_high(np.full((600, 2), 7.0), RATE, zero_phase=zero_phase)
        assert np.abs(left).max() < 1e-9


def test_the_chain_finds_a_booms_motion():
    """Zero phase, the chain is right within .04 mm rms; the causal form is not, by its phase.

    The motion has 3 to 5 mm rms. The causal filter is in error by 1.1 to 3.3 mm, .28 to .97 times
    the motion: what passes it leads by 83 degrees at .3 Hz. The chain before it adds at most
    .1 mm to this. Most of what is left with zero phase is the ripple of the decimation, below 1.2 %
    of the motion, so .2 mm is kept up to 17 mm rms.
    """
    for seed in range(5):
        motion, acceleration = make_boom(seed)
        x = integrate_twice(decimate(acceleration, RECORDED), RATE)
        zero, causal = (pass_high(x, RATE, zero_phase=z) for z in (True, False))
        truth, late = (pass_high(motion, RATE, zero_phase=z) for z in (True, False))
        for axis in range(3):
            size = rms(motion[:, axis])
            assert 0.002 < size < 0.006
            error = rms((zero - truth)[:, axis])
            assert error < 0.2e-3
            assert error < 0.012 * size
            assert rms((zero - motion)[:, axis]) < 0.2e-3
            assert 0.25 * size < rms((causal - truth)[:, axis]) < size
            assert rms((causal - late)[:, axis]) < 0.2e-3


def test_the_padding_keeps_the_ends_short():
    """10 to 20 s after the start the error is within .2 mm; with scipy's padding it is .4 mm."""
    motion, acceleration = make_boom(0)
    x = integrate_twice(decimate(acceleration, RECORDED), RATE)
    early = (pass_high(x, RATE) - motion)[200:400]
    assert np.sqrt(np.mean(early**2)) < 0.2e-3


def test_without_the_minus_the_motion_is_upside_down():
    motion, acceleration = make_boom(9)
    x = pass_high(integrate_twice(decimate(acceleration, RECORDED), RATE), RATE)
    assert np.corrcoef(x[INSIDE, 0], motion[INSIDE, 0])[0, 1] > 0.999
    assert rms((-x - motion)[:, 0]) == pytest.approx(2 * rms(motion[:, 0]), rel=0.02)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: decimate(np.zeros(20), 200.0), "signal: 20 samples are too few"),
        (lambda: pass_high(np.zeros(100), 20.0), "signal: lasts 5 s; more than 10 s would work"),
    ],
)
def test_refuses_what_cannot_be_filtered(call, message):
    with pytest.raises(InputError, match=message):
        call()
