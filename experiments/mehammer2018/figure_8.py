"""Figure 8 of Mehammer et al. (2018): velocities beside the passive observer.

    python -m experiments.mehammer2018.figure_8 [FOLDER]

FOLDER (default: results/floater_paper) gets a PNG and an SVG, of one record.
"""

import sys
from pathlib import Path

from experiments.mehammer2018.figures import draw_figures

folder = Path(sys.argv[1] if len(sys.argv) > 1 else "results/floater_paper")
for file in draw_figures(["figure_8"], folder):
    print(file)
