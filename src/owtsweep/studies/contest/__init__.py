"""What studies share in which schemes compete for the cells of a map with two of several axes.

Schemes that wait for later measurements do not compete: who needs an answer now cannot wait.
"""

from owtsweep.studies.contest.contest import WAIT, WINDOW, Contest

__all__ = ["WAIT", "WINDOW", "Contest"]
