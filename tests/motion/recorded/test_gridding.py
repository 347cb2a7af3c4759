"""Channels on the grid: resampled, derived, fixes placed, gaps kept."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from owtsweep.errors import InputError
from owtsweep.motion.recorded import Recording, checks, to_grid, to_motion

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
        error = np.abs(got.channels[f"{name}_x"] - truth)
        assert np.max(error[INNER]) < 1e-4 * OMEGA**order
        assert np.all(got.channels[f"{name}_y"] == 0.0)
    assert got.cutoff == 5.0
    assert any("5 Hz" in note for note in got.notes)


def test_irregular_times_come_out_regular() -> None:
    rng = np.random.default_rng(5)
    time = TIME + rng.uniform(-0.01, 0.01, len(TIME))
    got = to_motion(recording(time, position_x=motion(time)), 100.0)
    assert np.max(np.abs(got.channels["position_x"] - motion(got.grid.time))[INNER]) < 1e-3
    assert any("position_y" in note and "rest" in note for note in got.notes)


def test_rounded_times_are_not_taken_at_their_word() -> None:
    """80 Hz in whole milliseconds: a spline through those times would add 0.5 ms of jitter."""
    time = np.arange(4800) / 80.0
    got = to_motion(recording(np.round(time, 3), position_x=motion(time)), 100.0)
    error = got.channels["acceleration_x"] - motion(got.grid.time, 2)
    assert np.max(np.abs(error)[INNER]) < 2e-3 * OMEGA**2


def test_missing_samples_are_filled_and_long_gaps_of_a_reference_stay(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    lost = motion(TIME)
    lost[[300, 301, 500]] = np.nan
    lost[(TIME > 40.0) & (TIME < 42.0)] = np.nan
    monkeypatch.setattr(checks, "LONGEST_GAP", 0.2)
    got = to_grid(recording(TIME, reference_x=lost), ["reference_x"], 100.0)
    values, time = got.channels["reference_x"], got.grid.time
    hidden = (time > 40.0 + 1e-6) & (time < 42.0 - 1e-6)
    np.testing.assert_array_equal(np.isnan(values), hidden)
    far = ~hidden & (np.abs(time - 41.0) > 3.0) & (time > 3) & (time < 57)
    assert np.max(np.abs(values - motion(time))[far]) < 2e-3


@pytest.mark.parametrize(("late", "step"), [(0.0031, 0), (0.0069, 1)])
def test_a_fix_goes_to_its_nearest_step_and_no_further(late: float, step: int) -> None:
    time = np.sort(np.concatenate([np.arange(6000) / 100.0, np.arange(2, 58) + late]))
    is_fix = np.isclose(time % 1.0, late)
    fixes = np.where(is_fix, motion(time), np.nan)
    force = np.where(is_fix, np.nan, motion(time, 2))
    got = to_grid(
        recording(time, specific_force_x=force, fix_x=fixes), ["specific_force_x", "fix_x"], 100.0
    )
    steps = np.flatnonzero(np.isfinite(got.channels["fix_x"]))
    np.testing.assert_array_equal(steps, 100 * np.arange(2, 58) + step)
    np.testing.assert_array_equal(got.channels["fix_x"][steps], fixes[is_fix])
    assert any("0.0031 s" in note for note in got.notes)
    np.testing.assert_allclose(
        got.channels["specific_force_x"][INNER], motion(got.grid.time, 2)[INNER], atol=1e-3
    )


def test_recorded_velocity_is_kept_and_compared() -> None:
    made = recording(TIME, position_x=motion(TIME), velocity_x=1.1 * motion(TIME, 1))
    got = to_motion(made, 100.0)
    error = got.channels["velocity_x"] - 1.1 * motion(got.grid.time, 1)
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
        to_grid(made, ["specific_force_x", "specific_force_y"], 100.0)


def test_what_already_stands_on_the_grid_is_left_alone() -> None:
    noise = np.random.default_rng(8).standard_normal(1200)
    made = recording(TIME, specific_force_x=noise)
    got = to_grid(made, ["specific_force_x"], 20.0)
    np.testing.assert_array_equal(got.channels["specific_force_x"], noise)
    assert not np.allclose(
        to_grid(made, ["specific_force_x"], 20.001).channels["specific_force_x"][:1000],
        noise[:1000],
        atol=0.1,
    )
