"""Checks for users who wrote a scheme, a source of motion or a study of their own."""

from owtsweep.testing.schemes import check_scheme
from owtsweep.testing.sources import (
    check_delayed_positions,
    check_derivatives,
    check_source,
    check_streams,
)
from owtsweep.testing.studies import (
    check_blocks_alone,
    check_failures,
    check_keys,
    check_plan,
    check_rows,
    check_run,
    check_study,
    check_tables,
)

__all__ = [
    "check_blocks_alone", "check_delayed_positions", "check_derivatives", "check_failures",
    "check_keys", "check_plan", "check_rows", "check_run", "check_scheme", "check_source",
    "check_streams", "check_study", "check_tables",
]  # fmt: skip
