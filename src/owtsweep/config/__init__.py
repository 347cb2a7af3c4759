"""The configuration: Hydra composes plain data, a study's model types them, and checks follow.

This package knows no study. `owtsweep.studies` finds the tree of YAML files and the pydantic model
of a study, and calls the three steps in order. After these steps no OmegaConf objects are used.
"""

from owtsweep.config.axes import Axis
from owtsweep.config.common import Compute, Config
from owtsweep.config.composition import Tree, compose_plain, conf_directory
from owtsweep.config.section import Finite, NotNegative, Positive, Section, key
from owtsweep.config.stored import dump
from owtsweep.config.typed import as_mapping, changed, checked, typed, with_values
from owtsweep.errors import require

__all__ = [
    "Axis", "Compute", "Config", "Finite", "NotNegative", "Positive", "Section", "Tree",
    "as_mapping", "changed", "checked", "compose_plain", "conf_directory", "dump", "key",
    "require", "typed", "with_values",
]  # fmt: skip
