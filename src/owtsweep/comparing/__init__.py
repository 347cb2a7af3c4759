"""Compare runs of one study: best schemes, boundaries, and their changes, with 95 % intervals.

A boundary is the value of a condition above which the second of two schemes is better than the
first. The package needs the rows of a run's results and a description of the run
(`comparison.Aspects`), which the study makes. The package does not depend on any study.
"""
