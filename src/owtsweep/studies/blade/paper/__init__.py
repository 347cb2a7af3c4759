"""Repeats and judges what Maes et al. (2018) say of their measurements."""
