"""Turns entries of the keys `schemes` and `baselines` into schemes: ours, or a user's."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NoReturn

from owtsweep.config import Plain
from owtsweep.errors import require
from owtsweep.studies.base.schemes import (
    AnyScheme,
    Entry,
    SchemeTable,
    StoredScheme,
    blame_code,
    list_names,
)
from owtsweep.studies.hub.contract import Scheme
from owtsweep.studies.hub.known import Known
from owtsweep.studies.hub.names import LISTED, list_entries

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig


class StoredHubScheme(StoredScheme, Scheme):
    """The stand-in for a user's scheme of the hub in a stored run."""

    kept = ("name", "linear", "batched")

    def __init__(self, entry: Mapping[str, object], described: Plain) -> None:
        super().__init__(entry, described)
        self.linear, self.batched = described["linear"], described["batched"]
        self.check_declared()

    def start(self, known: Known) -> NoReturn:
        """Raise `InputError`, because the code of a stored scheme is never run."""
        self.refuse()

    def kernel(self, known: Known, steps: int | None = None) -> NoReturn:
        """Raise `InputError`, because the code of a stored scheme is never run."""
        self.refuse()

    def own_kernel(self, known: Known, steps: int) -> NoReturn:
        """Raise `InputError`, because the code of a stored scheme is never run."""
        self.refuse()


class HubTable(SchemeTable):
    """The hub's schemes and baselines; a scheme may have variants, for which a tuning asks."""

    def list_entries(self, config: HubConfig) -> list[Entry]:
        """Return the entries of schemes and baselines."""
        return list_entries(config)

    def choose(self, config: HubConfig) -> list[AnyScheme]:
        """Return all schemes and baselines of the configuration of one tuning, in their variants.

        Raises
        ------
        InputError
            As `resolve_all`, or if a scheme has no variant for the configuration.
        """
        return [*resolve_all(self.list_entries(config), config)]


#: The schemes and baselines of the study.
SCHEMES = HubTable("hub", "owtsweep.studies.hub.schemes", LISTED, StoredHubScheme)


def resolve(entry: Entry) -> Scheme:
    """Return the scheme for which an entry stands; raises as `SchemeTable.resolve`."""
    scheme = SCHEMES.resolve(entry)
    assert isinstance(scheme, Scheme)
    return scheme


def resolve_all(entries: Sequence[Entry], config: HubConfig | None = None) -> list[Scheme]:
    """Return all schemes of a run, in the order of `entries` (the value of the key `schemes`).

    If `config`, the configuration of one tuning, is given, each scheme is replaced by the variant
    that it asks for.

    Raises
    ------
    InputError
        As `SchemeTable.resolve_all`, or if a scheme has no variant for the configuration.
    """
    schemes = [scheme for scheme in SCHEMES.resolve_all(entries) if isinstance(scheme, Scheme)]
    return schemes if config is None else [under(scheme, config) for scheme in schemes]


def scheme_names(config: HubConfig) -> list[str]:
    """Return the names of a configuration's schemes, without baselines, as in its key `schemes`."""
    return list_names(config.schemes)


def under(scheme: Scheme, config: HubConfig) -> Scheme:
    """Return the variant of a scheme for which the configuration of one tuning asks.

    Raises
    ------
    InputError
        If the scheme's method `under` fails or returns no scheme.
    """
    with blame_code(scheme.name, "its method `under` must return a scheme"):
        variant = scheme.under(config)
        require(isinstance(variant, Scheme), f"`under` gives a {type(variant).__name__}")
        variant.check_declared()
    return variant
