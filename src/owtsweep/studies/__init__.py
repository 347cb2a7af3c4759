"""The studies: each is a package with a class that implements `owtsweep.sweep.study.Study`."""

from owtsweep.studies.registry import compose, get_study, locate, make_config, names

__all__ = ["compose", "get_study", "locate", "make_config", "names"]
