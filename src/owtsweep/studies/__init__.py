"""The studies: each is a package with a class that implements `owtsweep.sweep.study.Study`."""

from owtsweep.studies.registry import compose, from_mapping, get_study, locate, names

__all__ = ["compose", "from_mapping", "get_study", "locate", "names"]
