"""Defines the protocols of a study that can choose where sensors go (the command `place`)."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

if TYPE_CHECKING:
    import pandas as pd
    from rich.console import RenderableType

    from owtsweep.config import Config


@dataclass(frozen=True)
class Question:
    """What `place` is asked, besides the configuration.

    Attributes
    ----------
    quantity
        Name of the quantity whose error the sensors shall lower; None: the study's first.
    count
        Most sensors to choose; None leaves it to the study.
    heights
        Heights to choose from, in m; None leaves them to the study.
    given
        The keys that the user sets by overrides.
    """

    quantity: str | None
    count: int | None
    heights: tuple[float, ...] | None
    given: frozenset[str]


class Placed(Protocol):
    """How many sensors are enough, and where they go."""

    @property
    def config(self) -> Config:
        """The configuration, with the sensors that are there already."""

    def table(self) -> pd.DataFrame:
        """Return a row for each number of sensors, with their heights and the predicted error."""

    def answer(self) -> RenderableType:
        """Return what the terminal shows: the answer, a short table, and what it rests on."""


@runtime_checkable
class Placing(Protocol):
    """The interface of a study that can choose where sensors go."""

    def list_place_defaults(self, given: Collection[str]) -> Sequence[str]:
        """Return the overrides that `place` puts before those of the user, who sets `given`.

        Raises
        ------
        InputError
            If a key that the user sets has no part in the choice.
        """

    def place(self, config: Any, question: Question) -> Placed:
        """Choose sensors one by one, and predict their errors without running a scheme.

        Raises
        ------
        InputError
            If the configuration or the question cannot be answered; the message says what could.
        """
