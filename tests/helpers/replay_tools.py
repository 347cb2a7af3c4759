"""Records made for the tests of the replay, and how they are run."""

from __future__ import annotations

import itertools
import math
import os
from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import pytest

from owtsweep.arrays import Array
from owtsweep.config import changed
from owtsweep.evaluation.trajectory import Trajectory
from owtsweep.motion.source import SpectralSource, translated
from owtsweep.studies import compose
from owtsweep.studies.hub.public import Scheme, Sensors
from owtsweep.studies.replay.config import ReplayConfig
from owtsweep.studies.replay.estimating import estimate_pieces
from owtsweep.studies.replay.measures import Measured, Tally
from owtsweep.studies.replay.record import ReplayRecord, Signals

ROOT = Path(__file__).parents[2]
DATA = Path(os.environ.get("OWTSWEEP_DATA", ROOT.parent / "shared/data"))
needs_data = pytest.mark.skipif(
    not (DATA / "broad10_imu_optical.csv.gz").is_file(),
    reason=f"the recorded files are not in {DATA} (set OWTSWEEP_DATA)",
)
ANGLE = np.deg2rad(30.0)
DIRECTION = np.array([np.cos(ANGLE), np.sin(ANGLE)])


def config_of(files: Sequence[Path], *overrides: str) -> ReplayConfig:
    """The configuration of a replay of some files."""
    config = compose(list(overrides), primary="replay")
    assert isinstance(config, ReplayConfig)
    return changed(config, grid=changed(config.grid, files=[str(file) for file in files]))


def motion(
    duration: float = 60.0,
    rate: float = 20.0,
    *,
    period: float = 4.0,
    rms: float = 0.3,
    seed: int = 0,
) -> tuple[np.ndarray, np.ndarray]:
    """Times and displacement along the waves of a synthesised record."""
    made = SpectralSource(translated(period), (0.05, 0.6), "rms").realise(
        lambda _: np.random.default_rng(seed), steps=round(duration * rate), step=1.0 / rate
    )
    return np.arange(len(made.position)) / rate, rms * made.position


def write_csv(path: Path, columns: dict[str, np.ndarray]) -> Path:
    """A CSV in which NaN is an empty field."""
    lines = [",".join(columns)]
    numbers = (np.asarray(values, dtype=float).tolist() for values in columns.values())
    for row in zip(*numbers, strict=True):
        lines.append(",".join("" if math.isnan(v) else repr(v) for v in row))
    path.write_text("\n".join(lines) + "\n")
    return path


def motion_file(path: Path, mean: tuple[float, float] = (0.0, 0.0), **how: float) -> Path:
    """A recorded motion."""
    time, d = motion(**how)
    xy = np.outer(d, DIRECTION) + np.array(mean)
    return write_csv(path, {"time": time, "position_x": xy[:, 0], "position_y": xy[:, 1]})


def sensor_file(
    path: Path,
    *,
    duration: float = 60.0,
    missing: Sequence[int] = (),
    jitter: float = 0.0,
    reference: bool = True,
    fixes: bool = True,
    noise: float = 0.03,
    seed: int = 0,
) -> Path:
    """Recorded sensors of one sinusoid per axis: force at 100 Hz, fixes at 1 Hz, .2 s late."""
    draw = np.random.default_rng(seed)
    step = 0.01
    time = step * np.arange(round(duration / step))
    omega = 2.0 * np.pi * np.array([0.25, 0.2])
    size = np.array([0.4, 0.3])
    position = size * np.sin(np.outer(time, omega))
    force = -(omega**2) * position + 0.15 * draw.standard_normal(position.shape)
    columns = {"time": time, "specific_force_x": force[:, 0], "specific_force_y": force[:, 1]}
    if reference:
        columns |= {"reference_x": position[:, 0], "reference_y": position[:, 1]}
    if fixes:
        fix = np.full(position.shape, np.nan)
        due = np.arange(0.4, duration - 0.5, 1.0)  # any phase against the start of the file
        for number, moment in enumerate(due):
            if number in missing:
                continue
            came = moment + jitter * draw.uniform(-1.0, 1.0)
            value = size * np.sin((moment - 0.2) * omega) + noise * draw.standard_normal(2)
            fix[round(came / step)] = value
        columns |= {"fix_x": fix[:, 0], "fix_y": fix[:, 1]}
    return write_csv(path, columns)


def estimate(
    config: ReplayConfig, scheme: Scheme, sensors: Sensors, signals: Signals
) -> Trajectory:
    """Run a scheme over a whole record at once."""
    return next(estimate_pieces(config, scheme, sensors, [signals], [0, signals.steps]))[0]


def collect_force(signals: Signals) -> Array:
    """(steps, 2) the whole specific force."""
    return next(signals.force(signals.steps))


def measure(
    record: ReplayRecord, fixes: Array, estimated: Trajectory, sensors: Sensors, settled: int
) -> Iterator[Measured]:
    """All measures of one replicate whose estimates are in memory as a whole."""
    tally = Tally(record, fixes, sensors, settled)
    for begin, end in itertools.pairwise(tally.edges):
        parts = (None if series is None else series[begin:end] for series in estimated)
        tally.add(Trajectory(*parts))
    yield from tally.measures()
