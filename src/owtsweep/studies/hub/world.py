"""What a world of the hub study is: one kind of truth, swept over its conditions."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping
from typing import ClassVar

from owtsweep.config import Plain
from owtsweep.motion.source import Source
from owtsweep.results.conditions import Condition, Grid, Value
from owtsweep.studies.base.axes import Axes, Values
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.sensors import Sensors

#: Value of a condition that leaves what the structure's file says.
LAYERS = "layers"


class World(Axes[HubConfig], ABC):
    """One kind of truth: a source of motion, and the conditions that it is swept over.

    name: the value of the key `motion` that chooses it.
    conditions, section: the axes of the grid, and the configuration's section with their values.
    has_spectrum: whether the motion has the spectrum of Eq. (1) of Ren et al. (2019).
    bytes_per_step, seconds_per_step: memory and computing time that the motion of a record needs
        per IMU step, besides what schemes need.
    """

    name: ClassVar[str]
    has_spectrum: ClassVar[bool]
    bytes_per_step: ClassVar[int]
    seconds_per_step: ClassVar[float]

    def get_grid(self, config: HubConfig) -> Grid:
        """Return name of a condition -> list of the values that the configuration gives it."""
        section = getattr(config, self.section)
        return {each.name: getattr(section, each.name) or [] for each in self.conditions}

    def get_values(self, config: HubConfig) -> Values:
        return self.get_grid(config)

    @abstractmethod
    def check(self, config: HubConfig) -> None:
        """Raise `InputError` if the settings of the motion do not fit together, or the sensors."""

    @abstractmethod
    def list_content(self, config: HubConfig) -> Plain:
        """Return what a block's numbers depend on because of the world, besides the conditions."""

    def list_pairing(self, config: HubConfig) -> Plain:
        """Return what two runs must share so that their records can be paired.

        An envelope changes no phase.
        """
        optional = dict.fromkeys(("motion", "structure", "plant_version", "peaks", "pace"))
        return {**optional, **self.list_content(config), "envelope": None}

    @abstractmethod
    def describe(self, config: HubConfig) -> str:
        """Return in words what is special about the motion; "" for a plain spectrum."""

    @abstractmethod
    def make_source(self, config: HubConfig, conditions: Mapping[str, Value]) -> Source:
        """Return the source of motion under some conditions.

        Raises InputError if it cannot be computed; the message names the key.
        """

    def describe_values(self, at: Mapping[str, Value]) -> str:
        """Return values of conditions in words, e.g. "hs 2 m, blades 0"; "" for no condition.

        What is as the structure's file says is not mentioned.
        """
        named = {condition.name: condition for condition in self.conditions}
        return ", ".join(
            f"{named[name].word} {named[name].show(v)}" for name, v in at.items() if v != LAYERS
        )

    def fit_sensors(self, source: Source, sensors: Sensors, config: HubConfig) -> Sensors:
        """Return what estimators may know of the sensors on this source of motion."""
        return sensors

    def list_doubts(self, config: HubConfig) -> list[str]:
        """Return sentences on what makes the motion doubtful."""
        return []


NATURAL_PERIOD = Condition(
    "natural_period", "natural period", "s", in_streams=True, plural="periods"
)
AMPLITUDE = Condition(
    "amplitude", "motion amplitude", "m", scale="log", enters="scale", plural="amplitudes"
)
#: The conditions of motion=spectrum.
CONDITIONS = (NATURAL_PERIOD, AMPLITUDE)
#: The schemes whose boundary is reported: the first is better at amplitudes below the boundary,
#: the second above.
BOUNDARY = ("HME2", "HME1")
