"""Judges what Mehammer et al. (2018) say, and draws their figures, in the study's truth."""
