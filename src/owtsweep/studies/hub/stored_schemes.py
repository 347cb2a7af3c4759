"""Stand-ins for users' schemes, for reading a stored run without running the schemes' code.

A run folder may be another person's. Reading a run must not execute the code that the run's
configuration names. So nothing is imported for an entry `{_target_: package.Class}` of a stored
configuration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NoReturn

from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.studies.base.users import check_name
from owtsweep.studies.hub.contract import Scheme


class StoredScheme(dict[str, Any]):
    """The stand-in for a user's scheme in a stored run: it has a name, but cannot start.

    The stand-in is a dict that equals the scheme's entry in the key `schemes`. So writing the
    configuration gives the text of the stored config.yaml.

    Attributes
    ----------
    name, linear
        The scheme's name, and whether the scheme is linear, as the run's plan.json states them.
    """

    def __init__(self, entry: Mapping[str, Any], name: str, linear: bool) -> None:
        super().__init__(entry)
        self.name, self.linear = name, linear

    def start(self, sensors: Any, tuning: Any) -> NoReturn:
        """Raise an error, because the code of a stored scheme is never run.

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
    """The stand-in for a user's scheme that had a kernel when its run was stored."""

    def kernel(self, sensors: Any, tuning: Any, steps: int | None = None) -> NoReturn:
        """Raise an error, because the code of a stored scheme is never run.

        Raises
        ------
        InputError
            Always.
        """
        self.start(sensors, tuning)


def describe(schemes: Sequence[Scheme]) -> list[dict[str, Any]]:
    """Return what plan.json stores of a run's schemes: one mapping per scheme, in the same order.

    Each mapping holds the scheme's `name`, whether the scheme is `linear`, and under `kernel`
    whether the scheme has a kernel for the batch engine.
    """
    return [
        {"name": scheme.name, "linear": scheme.linear, "kernel": hasattr(scheme, "kernel")}
        for scheme in schemes
    ]


def stand_in(entries: Any, described: Any) -> Any:
    """Replace users' schemes in the key `schemes` of a stored run by stand-ins that run no code.

    Return the list of entries with a `StoredScheme` in place of each mapping. An entry that is a
    name is kept.

    Parameters
    ----------
    entries
        The value of the key `schemes` in config.yaml. If it is no list, it is returned as it is.
    described
        The list that `describe` made of these entries, from the run's plan.json.

    Raises
    ------
    InputError
        If `described` is no list of one mapping per entry, or does not give a valid name and a bool
        `linear` for an entry that is a mapping.
    """
    if not isinstance(entries, list):
        return entries
    require(
        isinstance(described, list)
        and len(described) == len(entries)
        and all(isinstance(facts, Mapping) for facts in described),
        "schemes: plan.json describes other schemes than config.yaml names; run the sweep again",
    )
    return [
        _stand_in(entry, facts) if isinstance(entry, Mapping) else entry
        for entry, facts in zip(entries, described, strict=True)
    ]


def _stand_in(entry: Mapping[str, Any], facts: Mapping[str, Any]) -> StoredScheme:
    name, linear = facts.get("name"), facts.get("linear")
    require(
        isinstance(name, str) and name != "" and isinstance(linear, bool),
        "schemes: plan.json lacks the name of a scheme, or whether the scheme is linear; run the "
        "sweep again",
    )
    check_name(name)
    kind = StoredKernelScheme if facts.get("kernel") is True else StoredScheme
    return kind(entry, str(name), bool(linear))
