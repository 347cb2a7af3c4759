"""Figure 8 of Mehammer et al. (2018): velocities beside the passive observer.

    python -m experiments.mehammer2018.figure_8 [FOLDER]

FOLDER (default: results/floater_paper) gets a PNG and an SVG, of one record.
"""

from experiments.mehammer2018.figures import main

main("figure_8")
