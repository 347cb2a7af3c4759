"""Draw the damage at the ground over the direction of the waves, with and without a wave input.

    python experiments/tower/wave_yaw.py [FOLDER] [RECORDS]

FOLDER (default: results/tower_wave_yaw) gets wave_yaw.csv and wave_yaw.png. RECORDS is 3 by default
(about two minutes on two cores).
"""

import sys
from functools import partial
from pathlib import Path

from owtsweep.figures.drawings import save_figure
from owtsweep.io.steps import show_steps
from owtsweep.io.tables import write_table
from owtsweep.studies.tower.figures.wave_yaw import collect, draw_yaws
from owtsweep.studies.tower.origin import describe_origin
from owtsweep.studies.tower.paper.scenarios import NOISE, Scenario

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/tower_wave_yaw")
records = int(sys.argv[2]) if len(sys.argv) > 2 else 3
with show_steps():
    table = collect(range(records))
folder.mkdir(parents=True, exist_ok=True)
write_table(folder, "wave_yaw", table)
config = Scenario(sea="waves").compose([f"grid.replicates={records}"])
note = (
    f"{describe_origin(config)}, {NOISE:g} % noise; yaw as on the axis. S-N curve as printed. "
    "Lines: means; dots: records; grey: within 25 %. Across the waves there is little to estimate: "
    "side-side at 0 deg, wind alone moves the structure."
)
for file in save_figure(partial(draw_yaws, table, note), None)(folder, "wave_yaw"):
    print(file)
