"""Linear estimation: filters, smoothers, predictors and moving horizons, for any study."""

#: Version of this package's numbers. Raise it whenever a change alters a number that a study
#: stores.
NUMERICS_VERSION = 0
