"""Checks for users who wrote a scheme, a source of motion or a study of their own."""

from owtsweep.testing.schemes import check_scheme
from owtsweep.testing.sources import check_source
from owtsweep.testing.studies import check_study

__all__ = ["check_scheme", "check_source", "check_study"]
