"""Figure 6 of Mehammer et al. (2018): losses of .5 s.

    python -m experiments.mehammer2018.figure_6 [FOLDER]

FOLDER (default: results/floater_paper) gets a PNG and an SVG, of one record.
"""

from experiments.mehammer2018.figures import main

main("figure_6")
