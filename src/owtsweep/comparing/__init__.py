"""Compare runs of one study: best schemes, boundaries, and their changes, with 95 % intervals.

The package knows no study: it needs the rows of a run's results and the study's description of the
run (`comparison.Aspects`). A boundary is the value of a condition above which the second of two
schemes is better than the first.
"""
