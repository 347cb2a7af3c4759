"""Figures for every study: style, palette, the best-scheme map, the map in the terminal."""
