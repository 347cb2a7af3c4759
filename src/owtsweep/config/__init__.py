"""Make the configuration of a run from YAML files and overrides, in three steps.

Hydra composes plain data (dicts, lists and scalars). A study's pydantic model turns the plain data
into a frozen object and checks every key by itself. Then conditions on several keys are checked.
This package knows no study: `owtsweep.studies` finds the YAML files and the model of a study, and
calls the three steps in order. After the first step no OmegaConf objects are used.
"""

from owtsweep.config.common import AnyConfig, Compute, Config, Tree
from owtsweep.config.composition import admit, compose_plain, conf_directory, get_key
from owtsweep.config.grid import Axis
from owtsweep.config.section import Finite, NotNegative, Plain, Positive, Section, key
from owtsweep.config.stored import dump, dump_with_units
from owtsweep.config.typed import as_mapping, changed, checked, typed, with_values
from owtsweep.errors import require

__all__ = [
    "AnyConfig", "Axis", "Compute", "Config", "Finite", "NotNegative", "Plain", "Positive",
    "Section", "Tree", "admit", "as_mapping", "changed", "checked", "compose_plain",
    "conf_directory", "dump", "dump_with_units", "get_key", "key", "require", "typed",
    "with_values",
]  # fmt: skip
