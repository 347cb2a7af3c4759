"""Figures 9 to 13 of Maes et al. (2018) in our truth, and a picture of the blade itself.

    python experiments/blade/figures.py [FOLDER]

FOLDER (default: results/blade_paper) gets a PNG and an SVG of each, of one record.
"""

import sys
from pathlib import Path

from owtsweep.studies.blade.paper.figures import FIGURES, draw_figures
from owtsweep.studies.blade.paper.picture import draw_picture

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/blade_paper")
for file in [*draw_figures(list(FIGURES), folder), *draw_picture(folder)]:
    print(file)
