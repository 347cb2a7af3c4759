"""Advice for one case: which estimator, how good it is, and what would change that."""
