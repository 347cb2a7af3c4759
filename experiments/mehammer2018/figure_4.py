"""Figure 4 of Mehammer et al. (2018): R ten times too large.

    python -m experiments.mehammer2018.figure_4 [FOLDER]

FOLDER (default: results/floater_paper) gets a PNG and an SVG, of one record.
"""

from experiments.mehammer2018.figures import main

main("figure_4")
