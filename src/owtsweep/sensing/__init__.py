"""Models of sensor errors: noise, bias, losses and outliers."""

#: Version of this package's numbers. Raise it whenever a change alters a number that a study
#: stores.
NUMERICS_VERSION = 0
