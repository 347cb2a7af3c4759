"""Runs an estimator over measurements and evaluates its estimates."""

#: Version of this package's numbers. Raise it whenever a change alters a number that a study
#: stores.
NUMERICS_VERSION = 0
