"""Make the sample records that the package ships: `replay --sample` writes them for a user.

    python -m experiments.make_sample [FOLDER]

writes sample_motion.csv.gz and sample_sensors.csv.gz into FOLDER (default: the package's folder of
sample records). Both last 60 s. The hub moves along 30 degrees from x by Eq. (1) of Ren et al.
(2019), and across by a tenth as much; its mean is not zero.

- sample_motion.csv: the hub's position, 20 Hz, natural period 4 s, rms .3 m.
- sample_sensors.csv: another motion, natural period 3.5 s, rms .2 m, as the truth; a specific force
  (100 Hz, noise .15 m/s^2, a bias that walks) and position fixes (1 Hz, .2 s late, noise .03 m), as
  the hub study simulates them (sensors=strong_bias).
"""

from __future__ import annotations

import gzip
import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path

import numpy as np

from owtsweep.arrays import Array
from owtsweep.motion.source import Motion, SpectralSource, translated
from owtsweep.streams import stream
from owtsweep.studies.hub.public import make_sensors
from owtsweep.studies.replay.files import MOTION, SENSORS, find_data
from owtsweep.studies.replay.record import ReplayRecord, listen, make_fixes
from owtsweep.studies.replay.running import compose_replay

SEED = 2019
DURATION = 60.0  # s
BAND = (0.05, 0.6)  # Hz
ANGLE = np.deg2rad(30.0)
#: Rows: unit vectors along and across the waves.
DIRECTIONS = np.array([[np.cos(ANGLE), np.sin(ANGLE)], [-np.sin(ANGLE), np.cos(ANGLE)]])
ACROSS = 0.1
MEAN = np.array([0.85, 0.12])  # m


def move(name: str, period: float, rms: float, rate: float, history: int = 0) -> dict[str, Array]:
    """Make a motion in the plane: quantity -> values of shape (steps, 2).

    The quantities are position (m) and acceleration (m/s^2), and the positions before t = 0, which
    have `history` rows. `period` is the natural period (s), `rms` that along the waves (m).
    """
    size = np.array([rms, ACROSS * rms])

    def draw(direction: str) -> Motion:
        return SpectralSource(translated(period), BAND, "rms").realise(
            partial(stream, SEED, "sample", (name, direction), 0),
            steps=round(DURATION * rate),
            step=1.0 / rate,
            history=history,
        )

    drawn = [draw("along"), draw("across")]

    def turn(parts: Sequence[Array]) -> Array:
        return (np.column_stack(parts) * size) @ DIRECTIONS

    return {
        "position": MEAN + turn([motion.position for motion in drawn]),
        "acceleration": turn([motion.acceleration for motion in drawn]),
        "before": MEAN + turn([motion.before for motion in drawn]),
    }


def make_motion() -> str:
    """Make the text of sample_motion.csv."""
    rate = 20.0
    position = move("motion", 4.0, 0.3, rate)["position"]
    time = np.arange(len(position)) / rate
    lines = [f"{t:.2f},{x:.4f},{y:.4f}" for t, (x, y) in zip(time, position, strict=True)]
    return "\n".join(["time (s),position_x (m),position_y (m)", *lines]) + "\n"


def make_measurements() -> str:
    """Make the text of sample_sensors.csv."""
    config = compose_replay(["sensors=strong_bias", f"seed={SEED}"])
    sensors = make_sensors(config.sensors)
    hub = move("sensors", 3.5, 0.2, config.sensors.imu.rate, history=sensors.delay)
    position = hub["position"]
    steps = len(position)
    everywhere = np.concatenate([hub["before"], position])
    record = ReplayRecord(
        file=SENSORS, gnss="simulated", begin=0.0, step=sensors.step, steps=steps,
        origin=np.zeros(2), position=position, acceleration=hub["acceleration"],
        fixes=make_fixes(everywhere, sensors.delay, steps, sensors), truth="the sample", notes=(),
    )  # fmt: skip
    signals = listen(config, sensors, record, 0)
    force = next(signals.force(steps))
    fixes = {k * sensors.fix_interval: fix for k, fix in enumerate(signals.fixes)}
    names = "time (s),acc_x (m/s^2),acc_y (m/s^2),gnss_x (m),gnss_y (m),ref_x (m),ref_y (m)"
    lines = [names]
    for k, (f, p) in enumerate(zip(force, position, strict=True)):
        fix = "{:.4f},{:.4f}".format(*fixes[k]) if k in fixes else ","
        lines.append(f"{k * sensors.step:.2f},{f[0]:.3f},{f[1]:.3f},{fix},{p[0]:.4f},{p[1]:.4f}")
    return "\n".join(lines) + "\n"


def make(folder: Path) -> list[Path]:
    """Write both records, compressed, into a folder; return their paths."""
    paths = []
    for name, text in ((MOTION, make_motion()), (SENSORS, make_measurements())):
        paths.append(folder / f"{name}.gz")
        paths[-1].write_bytes(gzip.compress(text.encode(), mtime=0))
    return paths


if __name__ == "__main__":
    target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(str(find_data()))
    for path in make(target):
        print(f"{path} ({path.stat().st_size / 1000:.0f} kB)")
