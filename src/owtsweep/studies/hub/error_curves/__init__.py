"""Computes the errors of a scheme at each frequency of the motion, and of noise: its curves."""
