"""Linear estimation: filters, smoothers, predictors, horizons. It knows no turbine and no study."""

#: Raised whenever a change of this room alters a number that a study stores.
NUMERICS_VERSION = 0
