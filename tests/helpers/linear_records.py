"""Records and settings for the tests of the floater study's linear filters."""

from dataclasses import replace

import numpy as np
from scipy.linalg import expm

from owtsweep.studies.floater.contract import Measured, Setting, Truth
from owtsweep.studies.floater.schemes import SCHEMES
from owtsweep.studies.floater.tuning import Tuning

STEP = 0.05
#: Periods in s of a motion's lines, and their sizes.
PERIODS, SIZES = np.array([38.0, 33.0, 29.0, 10.0, 8.0]), np.array([1.0, 0.6, 0.4, 0.05, 0.03])


def tune(**values):
    """Return a tuning that knows everything, with other values."""
    known = {
        "losses": "known", "process": "truth", "process_share": 0.1, "bias": "truth",
        "bias_share": 0.03, "delay": "truth", "delay_declared": 0.0,
        "attitude": "reported", "angular_share": 1.0, "lag": 1.0, "start": "report",
        "cutoff": 1.0, "crossover": 1.0, "observer": 1.0,
    }  # fmt: skip
    return Tuning(**(known | values))


def move(times, seed):
    """Return position, velocity and acceleration of lines with random phases, (n, 6) each."""
    phase = np.random.default_rng(seed).uniform(0.0, 2.0 * np.pi, (len(PERIODS), 6))
    omega = 2.0 * np.pi / PERIODS[:, None]
    angle = omega * times[:, None, None] + phase
    lines = SIZES[:, None] * np.array([3.0, 1.0, 0.5, 0.01, 0.02, 0.015])
    return (
        np.sum(lines * np.sin(angle), axis=1),
        np.sum(omega * lines * np.cos(angle), axis=1),
        -np.sum(omega**2 * lines * np.sin(angle), axis=1),
    )


def make(seed=0, steps=4000, snr=20.0, delay=0.0, bias=0.0, mean=0.0, noisy=True, jitter=0.0):
    """Return truth, setting and measurements of a record; `bias` is a part of the std, as in grid.

    The setting knows noise, bias and delay. `mean` is the mean position in standard deviations.
    """
    rng = np.random.default_rng([seed, 1])
    times = np.arange(steps) * STEP
    p, v, a = move(times, seed)
    offset = mean * p.std(axis=0)
    share = 10.0 ** (-snr / 20.0)
    sigma = [share * p.std(axis=0), share * v[:, 3:].std(axis=0), share * a.std(axis=0)]
    size = bias * a.std(axis=0)
    white = [s * noisy * rng.standard_normal((steps, len(s))) for s in sigma]
    age = delay + jitter * STEP * rng.standard_normal(steps)
    measured = Measured(
        STEP,
        move(times - age, seed)[0] + offset + white[0],
        age,
        np.zeros(steps, dtype=bool),
        a + size * rng.standard_normal(6) + white[2],
        v[:, 3:] + white[1],
        None,
    )
    motion_sigma = np.stack([p.std(axis=0), v.std(axis=0), a.std(axis=0)])
    setting = Setting(
        STEP, *sigma, size, np.zeros(6), delay, motion_sigma, np.full(6, 0.17), False, True, tune()
    )
    truth = Truth(STEP, p + offset, v, a, v[:, 3:], np.zeros((steps, 3)))
    return truth, setting, measured


def lose(measured, lost, *, zeros):
    """Return measurements without the reports where `lost` (steps,) is true."""
    position = np.where(lost[:, None], 0.0 if zeros else np.nan, measured.position)
    return replace(measured, position=position, lost=lost)


def errors(truth, estimates, first=1000):
    """Return errors of position and velocity from a sample on, shape (steps, 6, 2)."""
    position = estimates.position - truth.position
    velocity = estimates.velocity - truth.velocity
    return np.stack([position, velocity], axis=-1)[first:]


def rms(values):
    """Return the root of the mean square over the first axis."""
    return np.sqrt(np.mean(values**2, axis=0))


def nees(error, covariance, first=1000):
    """Return the mean of e' P^-1 e / 2 over samples, shape (6,)."""
    P = np.broadcast_to(covariance, (first + len(error), 6, 2, 2))[first:]
    inverse = np.linalg.inv(P)
    return np.einsum("kci,kcij,kcj->kc", error, inverse, error).mean(axis=0) / 2.0


def run(name, setting, measured):
    return SCHEMES.resolve(name).prepare(setting).run(measured)


def losses(steps, rng, share=0.2):
    lost = rng.random(steps) < share
    lost[:3] = False
    return lost


def continuous(noise, duration):
    """Return F, what an input going from 1 to 0 and from 0 to 1 adds, and Q, by matrix powers."""
    A = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, -1.0], [0.0, 0.0, 0.0]])
    W = np.diag([0.0, noise.acceleration, noise.walk])
    both = expm(np.block([[-A, W], [np.zeros((3, 3)), A.T]]) * duration)
    F = both[3:, 3:].T
    line = np.zeros((5, 5))
    line[:3, :3], line[1, 3], line[3, 4] = A, 1.0, 1.0 / duration
    driven = expm(line * duration)
    rising, constant = driven[:3, 4], driven[:3, 3]
    return F, constant - rising, rising, F @ both[:3, 3:]
