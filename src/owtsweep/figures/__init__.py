"""Figures that serve every study: style, palette, the best-scheme map, the terminal's map."""
