"""Motion of a structure: spectra, records made from them, recorded motion.

This package imports neither sensors nor estimators.
"""

#: Raised whenever a change of this package alters a number that a study stores.
NUMERICS_VERSION = 0
