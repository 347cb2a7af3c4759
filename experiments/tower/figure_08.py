"""Figure 8 of Simpson et al. (2025): loads at the ground.

    python experiments/tower/figure_08.py [FOLDER]

FOLDER (default: results/tower_paper) gets a PNG and an SVG, of one record.
"""

import sys
from pathlib import Path

from owtsweep.studies.tower.paper.figures import draw_figures

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/tower_paper")
for file in draw_figures(["figure_08"], folder):
    print(file)
