"""Figure 5 of Mehammer et al. (2018): delay of one step.

    python -m experiments.mehammer2018.figure_5 [FOLDER]

FOLDER (default: results/floater_paper) gets a PNG and an SVG, of one record.
"""

from experiments.mehammer2018.figures import main

main("figure_5")
