"""The contracts of schemes and studies as checks that anybody can run on theirs."""

from owtsweep.testing.schemes import (
    check_declaration,
    check_estimates,
    check_inputs,
    check_kernel,
    check_scheme,
    check_starts,
    check_superposition,
    example_sensors,
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
    "check_blocks_alone", "check_declaration", "check_estimates", "check_failures", "check_inputs",
    "check_kernel", "check_keys", "check_plan", "check_rows", "check_run", "check_scheme",
    "check_starts", "check_study", "check_superposition", "check_tables", "example_sensors",
]  # fmt: skip
