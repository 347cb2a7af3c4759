"""Defines the protocols of a study whose errors can be shown over the values of one key.

The command `vary` uses them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol, runtime_checkable

if TYPE_CHECKING:
    from rich.console import RenderableType

    from owtsweep.results.conditions import Condition, Value


class Varied(Protocol):
    """The errors of a study's schemes over the values of one key."""

    def write(self, folder: Path, metadata: Mapping[str, str]) -> list[Path]:
        """Write the table vary.csv and the figure into `folder`; return the paths of the files.

        `metadata` holds texts by name to store in the figure's files.
        """

    def answer(self) -> RenderableType:
        """Return what the terminal shows: a short table, and sentences that answer."""


@runtime_checkable
class Varying(Protocol):
    """The interface of a study that can show its errors over the values of one key."""

    def list_vary_defaults(self) -> Sequence[str]:
        """Return the overrides that `vary` puts before those of the user.

        The command leaves out an override whose key the user sets, or whose section.
        """

    def check_vary(self, along: Condition, configs: Mapping[Value, Any]) -> None:
        """Check that the errors can be computed with these configurations, and shown together.

        The arguments are those of `vary`.

        Raises
        ------
        InputError
            If they cannot be computed or shown together.
        """

    def vary(self, along: Condition, configs: Mapping[Value, Any]) -> Varied:
        """Compute the errors of all schemes with each configuration, which `check_vary` has passed.

        Parameters
        ----------
        along
            The key that is varied: its name as `label`, its unit and its scale.
        configs
            Value of the key -> the configuration with this value, in the order of the table.

        Raises
        ------
        InputError
            If a scheme cannot be computed.
        """
