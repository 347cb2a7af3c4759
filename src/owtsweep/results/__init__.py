"""Summaries of the rows of a run: a cube over its conditions, tables, boundaries."""
