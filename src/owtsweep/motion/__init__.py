"""Motion of a structure: spectra, records drawn from spectra, and recorded motion.

This package imports neither sensors nor estimators.
"""

#: Version of this package's numbers. Raise it whenever a change alters a number that a study
#: stores.
NUMERICS_VERSION = 0
