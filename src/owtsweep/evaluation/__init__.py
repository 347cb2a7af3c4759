"""Running an estimator over measurements, and measuring what it gives."""

#: Raised whenever a change of this room alters a number that a study stores.
NUMERICS_VERSION = 0
