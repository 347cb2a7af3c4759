"""Figure 10 of Simpson et al. (2025): offset of F175 with and without gravity.

    python -m experiments.simpson2025.figure_10 [FOLDER]

FOLDER (default: results/tower_paper) gets a PNG and an SVG, of one record.
"""

from experiments.simpson2025.figures import main

main("figure_10")
