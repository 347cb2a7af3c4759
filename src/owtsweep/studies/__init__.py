"""The studies: each is a package with a class that implements `owtsweep.sweep.study.Study`."""

from owtsweep.studies.composing import compose, from_mapping, locate
from owtsweep.studies.registry import get_study, names

__all__ = ["compose", "from_mapping", "get_study", "locate", "names"]
