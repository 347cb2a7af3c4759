"""Tuning: the search for each scheme's best numbers for given sensors, and rules found by it."""
