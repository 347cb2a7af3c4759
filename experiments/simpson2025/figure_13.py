"""Figure 13 of Simpson et al. (2025): loads at the ground with waves, over time and frequency.

    python -m experiments.simpson2025.figure_13 [FOLDER]

FOLDER (default: results/tower_paper) gets a PNG and an SVG for each wave direction, of one record.
"""

from experiments.simpson2025.figures import main

main("figure_13_yaw_0", "figure_13_yaw_30")
