"""Summarises the rows of a run: as arrays over the conditions, as tables, and by boundaries."""
