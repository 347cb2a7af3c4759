"""Stands for a user's scheme of a stored run: what is known of it, without its code.

A run folder may be another person's. Reading it must not execute what it names, so nothing is
imported for an entry `{_target_: package.Class}` of a stored configuration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.studies.hub.contract import Scheme


class StoredScheme(dict[str, Any]):
    """`owtsweep.studies.hub.contract.Scheme` for reading: it has a name, and cannot start.

    It is also the entry of the key `schemes` for which it stands, so that the configuration keeps
    its text.

    Attributes
    ----------
    name, linear
        As the run's plan.json states them.
    """

    def __init__(self, entry: Mapping[str, Any], name: str, linear: bool) -> None:
        super().__init__(entry)
        self.name, self.linear = name, linear

    def start(self, sensors: Any, tuning: Any) -> NoReturn:
        """Refuse: the code of a stored scheme is never run.

        Raises
        ------
        InputError
            Always.
        """
        raise InputError(
            f"schemes: {self.name} is a scheme of the stored run's author, whose code is not run; "
            "sweep with schemes=[{_target_: package.Class}] to run one of your own"
        )


class StoredKernelScheme(StoredScheme):
    """A stored scheme that had a kernel."""

    def kernel(self, sensors: Any, tuning: Any, steps: int | None = None) -> NoReturn:
        """Refuse, as `start` does.

        Raises
        ------
        InputError
            Always.
        """
        self.start(sensors, tuning)


#: Most characters of a scheme's name: it stands in the cells and legends of figures.
LONGEST_NAME = 60


def check_name(name: Any) -> None:
    """Check that a scheme's name can be shown in tables, figures and a terminal.

    Raises
    ------
    InputError
        If it is no text, empty, too long, or holds a control character.
    """
    require(
        isinstance(name, str) and 0 < len(name) <= LONGEST_NAME and name.isprintable(),
        f"schemes: the name {str(name)[:LONGEST_NAME]!r} cannot be used; give one of 1 to "
        f"{LONGEST_NAME} printable characters",
    )


def describe(schemes: Sequence[Scheme]) -> list[dict[str, Any]]:
    """What plan.json holds of the schemes of a run, in their order."""
    return [
        {"name": scheme.name, "linear": scheme.linear, "kernel": hasattr(scheme, "kernel")}
        for scheme in schemes
    ]


def stand_in(entries: Any, described: Any) -> Any:
    """The entries of a stored key `schemes`, with a `StoredScheme` for each user's scheme.

    Parameters
    ----------
    entries
        The list as config.yaml has it. If it is no list, it is returned as it is.
    described
        As `describe` made it; None for a run of before plans were stored. Then a scheme is called
        like its class.

    Raises
    ------
    InputError
        If the description is not one of these entries.
    """
    if not isinstance(entries, list):
        return entries
    if described is None:
        described = [{"name": _class_name(entry), "linear": True} for entry in entries]
    require(
        isinstance(described, list)
        and len(described) == len(entries)
        and all(isinstance(facts, Mapping) for facts in described),
        "schemes: plan.json describes other schemes than config.yaml names",
    )
    return [
        _stand_in(entry, facts) if isinstance(entry, Mapping) else entry
        for entry, facts in zip(entries, described, strict=True)
    ]


def _stand_in(entry: Mapping[str, Any], facts: Mapping[str, Any]) -> StoredScheme:
    name, linear = facts.get("name"), facts.get("linear")
    require(
        isinstance(name, str) and name != "" and isinstance(linear, bool),
        "schemes: plan.json gives a scheme without a name, or does not say whether it is linear",
    )
    check_name(name)
    kind = StoredKernelScheme if facts.get("kernel") is True else StoredScheme
    return kind(entry, str(name), bool(linear))


def _class_name(entry: Any) -> str:
    target = entry.get("_target_") if isinstance(entry, Mapping) else entry
    return str(target).rpartition(".")[2]
