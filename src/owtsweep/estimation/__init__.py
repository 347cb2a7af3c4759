"""Linear estimation: filters, smoothers, predictors and horizons, independent of any study."""

#: Raised whenever a change of this package alters a number that a study stores.
NUMERICS_VERSION = 0
