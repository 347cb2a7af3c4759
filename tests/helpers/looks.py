"""The reserved looks of the hub's schemes and baselines."""

from owtsweep.studies.hub.contract import LISTED

LOOKS = {name: listed.look for name, listed in LISTED.items() if listed.look is not None}
