"""Figure 3 of Mehammer et al. (2018): noise of 10 dB.

    python -m experiments.mehammer2018.figure_3 [FOLDER]

FOLDER (default: results/floater_paper) gets a PNG and an SVG, of one record.
"""

from experiments.mehammer2018.figures import main

main("figure_3")
