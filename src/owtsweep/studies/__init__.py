"""The studies. Each lives in a package of its own and answers to `owtsweep.sweep.study.Study`."""

from owtsweep.config import compose
from owtsweep.config import load as load_config
from owtsweep.errors import InputError
from owtsweep.sweep.study import Block, Study

__all__ = ["Block", "Study", "compose", "get_study", "load_config"]

STUDIES = ("hub", "readings", "replay")


def get_study(name: str) -> Study:
    """Return the study of that name, importing only what it needs.

    Raises
    ------
    InputError
        If there is no such study.
    """
    if name == "hub":
        from owtsweep.studies.hub import HubStudy

        return HubStudy()
    if name == "readings":
        from owtsweep.studies.readings import ReadingsStudy

        return ReadingsStudy()
    if name == "replay":
        from owtsweep.studies.replay import ReplayStudy

        return ReplayStudy()
    raise InputError(f"study: there is no study {name!r}; known: {', '.join(STUDIES)}")
