"""The house of the studies floater, blade, tower and mating: what follows from a declaration.

A study declares its axes, its schemes, and the way from truth to score (`declaration`). Plan, rows,
tables, maps, the lines on the terminal, comparisons and `owtsweep.estimate` follow from it.
"""
