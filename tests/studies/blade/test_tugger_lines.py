"""Gusts that are stated, and tugger lines, by brute force."""

from __future__ import annotations

import numpy as np
import pytest
from hanging import make

from owtsweep.studies.blade.contest import CONTEST
from owtsweep.studies.blade.sections import Freedom
from owtsweep.studies.blade.truth import choose_freedoms, hold

FREEDOM = Freedom(period=20.0, damping=0.05, sigma=0.8, gust=0.2)


def sum_up(stiffness, damper, frequency):
    """Return power of an oscillator's motion under white noise, by its own equation."""
    w = 2.0 * np.pi * frequency
    w0 = 2.0 * np.pi / FREEDOM.period
    pull = w0**2 * (1.0 + stiffness) - w**2 + 2j * (FREEDOM.damping + damper) * w0 * w
    return np.abs(1.0 / pull) ** 2


@pytest.mark.parametrize(("stiffness", "damper"), [(0.0, 0.0), (3.0, 0.0), (0.0, 0.1), (3.0, 0.1)])
def test_lines_are_springs_and_dampers(stiffness, damper) -> None:
    frequency = np.linspace(0.0, 20.0, 2_000_001)
    power = [sum_up(*lines, frequency).sum() for lines in ((stiffness, damper), (0.0, 0.0))]
    held = hold(FREEDOM, stiffness, damper)
    period, damping, sigma, gust = held.period, held.damping, held.sigma, held.gust
    assert sigma == pytest.approx(0.8 * np.sqrt(power[0] / power[1]), rel=1e-3)
    assert gust == pytest.approx(0.2 / (1.0 + stiffness))
    # the response to a push at 0 Hz and at the natural frequency
    w = 2.0 * np.pi / period
    peak = np.sqrt(sum_up(stiffness, damper, 1.0 / period))
    assert peak == pytest.approx(1.0 / (2.0 * damping * w**2))
    if stiffness == damper == 0.0:
        assert (period, damping, sigma, gust) == (20.0, 0.05, 0.8, 0.2)


def test_lines_hold_the_heading_and_nothing_else() -> None:
    words = ("motion.tugger.heading=3", "motion.tugger.damping=0.1")
    free, held = (make(*lines)[1].series.position for lines in ((), words))
    assert np.array_equal(free[:, [0, 1, 2, 5]], held[:, [0, 1, 2, 5]])
    assert held[:, 3].std() < 0.6 * free[:, 3].std()
    config = make(*words)[0]
    (cell,) = CONTEST.list_cells(config)
    held = choose_freedoms(config, cell)["heading"]
    assert (held.period, held.gust) == pytest.approx((10.0, 0.05))
    assert (held.damping, held.sigma) == pytest.approx((0.075, 0.8 / np.sqrt(12.0)))
    config = make(*words, "grid.heading=[2]")[0]
    (cell,) = CONTEST.list_cells(config)
    assert choose_freedoms(config, cell)["heading"].sigma == 2.0


def test_gusts_are_stated_for_each_freedom() -> None:
    calm = [f"motion.freedoms.{name}.gust=0" for name in ("u", "v", "w", "heading", "roll")]
    still = [f"motion.freedoms.{name}.sigma=0" for name in ("u", "v", "w", "heading", "pitch",
                                                             "roll")]  # fmt: skip
    motion = make(*calm, *still, "motion.freedoms.pitch.gust=2", short=False)[1]
    moved = motion.series.position
    assert np.all(moved[:, [0, 1, 2, 3, 5]] == 0.0)
    pitch = np.rad2deg(moved[motion.lead :, 4])
    assert 1.0 < pitch.std() < 3.0
    spectrum = np.abs(np.fft.rfft((pitch - pitch.mean()) * np.hanning(len(pitch)))) ** 2
    frequency = np.fft.rfftfreq(len(pitch), 0.02)
    assert spectrum[frequency > 0.21].sum() < 1e-6 * spectrum.sum()
