"""Case studies of Simpson et al. (2025), run with the tower study's own parts, and judged."""
