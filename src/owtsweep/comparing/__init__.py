"""Compare runs of one study: best schemes, boundaries, and their changes, with 95 % intervals.

The package works on the rows of a run and on the study's description of the run
(`aspects.Aspects`). It does not depend on any study.
"""
