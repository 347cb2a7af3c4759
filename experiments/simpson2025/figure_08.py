"""Figure 8 of Simpson et al. (2025): loads at the ground.

    python -m experiments.simpson2025.figure_08 [FOLDER]

FOLDER (default: results/tower_paper) gets a PNG and an SVG, of one record.
"""

from experiments.simpson2025.figures import main

main("figure_08")
