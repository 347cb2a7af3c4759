"""Motion of a structure: spectra, records made from them, recorded motion.

This room imports neither sensors nor estimators.
"""
