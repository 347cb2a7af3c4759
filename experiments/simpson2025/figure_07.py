"""Figure 7 of Simpson et al. (2025): damage along the substructure, wind only.

    python -m experiments.simpson2025.figure_07 [FOLDER]

FOLDER (default: results/tower_paper) gets a PNG and an SVG, of one record.
"""

from experiments.simpson2025.figures import main

main("figure_07")
