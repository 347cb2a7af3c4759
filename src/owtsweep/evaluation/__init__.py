"""Run an estimator over the measurements of a record, and evaluate the estimates."""

#: Version of this package's numbers. Raise it whenever a change alters a number that a study
#: stores.
NUMERICS_VERSION = 1
