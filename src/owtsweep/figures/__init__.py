"""Figures for every study: style, palette, the best-scheme map, the map in the terminal.

Functions that draw are called under `style.context`; `drawings.save_figure` sees to that.
"""
