"""Figures for every study: style, palette, the best-scheme map, the map in the terminal.

Call functions that draw under `style.context`, as `drawings.save_figure` does.
"""
