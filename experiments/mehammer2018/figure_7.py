"""Figure 7 of Mehammer et al. (2018): steady-state and time-varying filter in a decay.

    python -m experiments.mehammer2018.figure_7 [FOLDER]

FOLDER (default: results/floater_paper) gets a PNG and an SVG, of one record.
"""

from experiments.mehammer2018.figures import main

main("figure_7")
