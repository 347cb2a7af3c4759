"""What an IMU that leans with the tower costs over the natural period, and what knowing it saves.

    python -m experiments.tilt [FOLDER]

Writes tilt_cost.csv, tilt_cost.png and tilt_cost.svg into FOLDER (default: results/tilt). The tilt
is that of the first mode of Ren's turbine (conf/structure/ren2019.yaml); the schemes are those of
tuning=matched at the default sensors; no record is drawn.
"""

import sys
from pathlib import Path

import numpy as np

import owtsweep
from owtsweep.config import conf_directory
from owtsweep.figures import style
from owtsweep.io.tables import write_table
from owtsweep.structures import compute_modes, read_structure
from owtsweep.studies.hub.figures.tilt_cost import draw
from owtsweep.studies.hub.tilt_cost import compare_knowledge

AMPLITUDES = (0.5, 2.0)  # m, largest displacement
PERIODS = np.arange(3.0, 8.01, 0.5)  # s

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/tilt")
modes = compute_modes(read_structure(conf_directory() / "structure" / "ren2019.yaml"), 1)
tilt = float(modes.slope[0])
config = owtsweep.studies.compose(["tuning=matched"])
costs = compare_knowledge(config, tilt, PERIODS, AMPLITUDES)
folder.mkdir(parents=True, exist_ok=True)
write_table(folder, "tilt_cost", costs)
print(folder / "tilt_cost.csv")
title = f"What a tilt of the IMU of {tilt:.4f} rad/m costs, and what knowing it gives back"
origin = (
    f"Tuning {config.tuning_name}, default sensors. Settled errors by linear theory, so there are "
    "no records and no seed. Known to 20 %: the larger error of two beliefs, 20 % too small and "
    "20 % too large. "
    "The bound is of the Kalman filter that assumes nothing about the motion."
)
with style.context():
    for file in style.save(draw(costs, title=title, origin=origin), folder, "tilt_cost", None):
        print(file)
