"""Channels on the grid: resampled, derived, fixes placed, gaps kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from owtsweep.errors import InputError
from owtsweep.motion.recorded import Recording, checks, find_common_grid, to_grid, to_motion

OMEGA = 2 * np.pi * 0.3


def motion(time: np.ndarray, order: int = 0) -> np.ndarray:
    return OMEGA**order * np.sin(OMEGA * time + 0.4 + order * np.pi / 2)


def recording(time: np.ndarray, **channels: np.ndarray) -> Recording:
    names = {role: role for role in ("time", *channels)}
    return Recording(Path("made.npz"), time, channels, names, ())


TIME = np.arange(1200) / 20.0
INNER = slice(1000, 5000)  # 10 s from either end, on a grid of 100 Hz


def test_motion_is_derived_on_the_grid_of_the_imu() -> None:
    got = to_motion(recording(TIME, position_x=motion(TIME), position_y=0 * TIME), 100.0)
    for order, name in enumerate(("position", "velocity", "acceleration")):
        truth = motion(got.grid.time, order)
        error = np.abs(got.pairs[name][:, 0] - truth)
        assert np.max(error[INNER]) < 1e-4 * OMEGA**order
        assert np.all(got.pairs[name][:, 1] == 0.0)
    assert got.cutoff == 5.0
    assert any("5 Hz" in note for note in got.notes)


def test_irregular_times_come_out_regular() -> None:
    rng = np.random.default_rng(5)
    time = TIME + rng.uniform(-0.01, 0.01, len(TIME))
    got = to_motion(recording(time, position_x=motion(time)), 100.0)
    assert np.max(np.abs(got.pairs["position"][:, 0] - motion(got.grid.time))[INNER]) < 1e-3
    assert any("position_y" in note and "rest" in note for note in got.notes)


def test_rounded_times_are_not_taken_at_their_word() -> None:
    """80 Hz in whole milliseconds: a spline through those times would add 0.5 ms of jitter."""
    time = np.arange(4800) / 80.0
    got = to_motion(recording(np.round(time, 3), position_x=motion(time)), 100.0)
    error = got.pairs["acceleration"][:, 0] - motion(got.grid.time, 2)
    assert np.max(np.abs(error)[INNER]) < 2e-3 * OMEGA**2


def test_missing_samples_are_filled_and_long_gaps_of_a_reference_stay(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lost = motion(TIME)
    lost[[300, 301, 500]] = np.nan
    lost[(TIME > 40.0) & (TIME < 42.0)] = np.nan
    monkeypatch.setattr(checks, "LONGEST_GAP", 0.2)
    got = to_motion(recording(TIME, reference_x=lost), 100.0, quantity="reference", orders=1)
    values, time = got.pairs["position"][:, 0], got.grid.time
    hidden = (time > 40.0 + 1e-6) & (time < 42.0 - 1e-6)
    np.testing.assert_array_equal(np.isnan(values), hidden)
    far = ~hidden & (np.abs(time - 41.0) > 3.0) & (time > 3) & (time < 57)
    assert np.max(np.abs(values - motion(time))[far]) < 2e-3


def test_recorded_velocity_is_kept_and_compared() -> None:
    made = recording(TIME, position_x=motion(TIME), velocity_x=1.1 * motion(TIME, 1))
    got = to_motion(made, 100.0)
    error = got.pairs["velocity"][:, 0] - 1.1 * motion(got.grid.time, 1)
    assert np.max(np.abs(error)[INNER]) < 1e-3
    assert any("velocity_x taken as recorded" in note and "10 %" in note for note in got.notes)


@pytest.mark.parametrize("cutoff", [0.0, -1.0, 9.0])
def test_a_cutoff_that_the_record_cannot_have(cutoff: float) -> None:
    with pytest.raises(InputError, match="not between 0 and 8 Hz"):
        to_motion(recording(TIME, position_x=motion(TIME)), 100.0, cutoff=cutoff)


def test_channels_that_never_meet() -> None:
    early, late = motion(TIME), motion(TIME)
    early[600:] = np.nan
    late[:610] = np.nan
    made = recording(TIME, specific_force_x=early, specific_force_y=late)
    with pytest.raises(InputError, match="share 0 s"):
        find_common_grid(made, ["specific_force_x", "specific_force_y"], 100.0)


def test_what_already_stands_on_the_grid_is_left_alone() -> None:
    noise = np.random.default_rng(8).standard_normal(1200)
    made = recording(TIME, specific_force_x=noise)
    role = "specific_force_x"
    same, other = (find_common_grid(made, [role], rate) for rate in (20.0, 20.001))
    np.testing.assert_array_equal(to_grid(made, role, same), noise)
    assert not np.allclose(
        to_grid(made, role, other)[:1000],
        noise[:1000],
        atol=0.1,
    )
