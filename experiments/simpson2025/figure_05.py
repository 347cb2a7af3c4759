"""Figure 5 of Simpson et al. (2025): displacement and rotation at 0 m and 15 m.

    python -m experiments.simpson2025.figure_05 [FOLDER]

FOLDER (default: results/tower_paper) gets a PNG and an SVG, of one record.
"""

from experiments.simpson2025.figures import main

main("figure_05")
