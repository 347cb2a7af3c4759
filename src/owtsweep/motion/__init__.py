"""Motion of a structure: spectra, records made from them, recorded motion.

This package imports neither sensors nor estimators.
"""

#: Version of this package's numbers. Raise it whenever a change alters a number that a study
#: stores.
NUMERICS_VERSION = 0
