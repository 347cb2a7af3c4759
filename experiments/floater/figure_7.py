"""Figure 7 of Mehammer et al. (2018): steady-state and time-varying filter in a decay.

    python experiments/floater/figure_7.py [FOLDER]

FOLDER (default: results/floater_paper) gets a PNG and an SVG, of one record.
"""

import sys
from pathlib import Path

from owtsweep.studies.floater.paper.figures import draw_figures

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/floater_paper")
for file in draw_figures(["figure_7"], folder):
    print(file)
