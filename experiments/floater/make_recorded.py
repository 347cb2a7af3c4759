"""Make the record of a floater in a basin, as a user would hand in a record of the user's own.

    python -m experiments.floater.make_recorded [FILE]

writes basin.csv (default): 300 s at 20 Hz of time, surge, sway, heave in m, and roll, pitch, yaw in
degrees (docs/floater.md). It is a synthetic motion of the study with a seed and periods of its own;
no noise is in it: the study adds it. Always the same bytes.
"""

import sys
from pathlib import Path

import numpy as np

from owtsweep.studies import compose
from owtsweep.studies.floater.truth import make_truth

HEADER = "Time (s),SURGE (m),SWAY (m),HEAVE (m),ROLL (deg),PITCH (deg),YAW (deg)"
WORDS = ["seed=77", "record.duration=300", "motion.wave_period=8"]

target = Path(sys.argv[1]) if len(sys.argv) > 1 else Path("basin.csv")
truth = make_truth(compose(["study=floater", *WORDS]), 0).truth
position = truth.position.copy()
position[:, 3:] = np.rad2deg(position[:, 3:])
table = np.column_stack([truth.step * np.arange(len(position)), position])
np.savetxt(target, table, "%.8g", ",", header=HEADER, comments="")
print(f"{target} ({target.stat().st_size / 1e6:.1f} MB)")
