"""Figure 4 of Simpson et al. (2025): modes of the free substructure.

    python -m experiments.simpson2025.figure_04 [FOLDER]

FOLDER (default: results/tower_paper) gets a PNG and an SVG, of one record.
"""

from experiments.simpson2025.figures import main

main("figure_04")
