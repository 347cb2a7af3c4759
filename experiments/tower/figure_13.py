"""Figure 13 of Simpson et al. (2025): loads at the ground with waves, over time and frequency.

    python experiments/tower/figure_13.py [FOLDER]

FOLDER (default: results/tower_paper) gets a PNG and an SVG for each wave direction, of one record.
"""

import sys
from pathlib import Path

from owtsweep.studies.tower.paper.figures import draw_figures

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/tower_paper")
for file in draw_figures(["figure_13_yaw_0", "figure_13_yaw_30"], folder):
    print(file)
