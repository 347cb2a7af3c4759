"""A configuration whose tuned sections may be those of one tuning, or of several.

A tuning is a file of the config group `tuning`. It sets the sections `Config.tuned` and the key
`tuning`, its name. All other keys belong to the run. Several tunings are composed one by one, then
joined to one configuration.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

from pydantic import SerializerFunctionWrapHandler, model_serializer

from owtsweep.config.common import Config
from owtsweep.config.hints import list_keys
from owtsweep.config.section import Section
from owtsweep.errors import InputError, require

#: The config group of tunings, and the key that names the tunings of a run.
GROUP = "tuning"
#: The key that holds the tuned sections of each tuning of a run with several.
SECTIONS = "tunings"
#: The value of a key that stands in `tunings.<name>`.
ABSENT: Any = None


class TunedConfig(Config):
    """A configuration with the keys `tuning` and `tunings`, and the sections `tuned`.

    With several tunings, `tuning` is the list of their names, `tunings` holds their sections, and
    the sections `tuned` are absent. The study declares all these keys.
    """

    if TYPE_CHECKING:
        tuning: str | list[str]
        tunings: Mapping[str, Section]

    @model_serializer(mode="wrap")
    def _leave_out_absent_keys(self, dump: SerializerFunctionWrapHandler) -> dict[str, object]:
        absent = self.tuned if self.tunings else ("tunings",)
        return {name: value for name, value in dump(self).items() if name not in absent}

    def by_tuning(self) -> Mapping[str, Self]:
        """Return tuning -> the configuration of a run with this tuning alone."""
        if not self.tunings:
            return {"": self}
        return {
            name: self.model_copy(update={"tuning": name, "tunings": {}, **vars(tuned)})
            for name, tuned in self.tunings.items()
        }

    @property
    def tuning_name(self) -> str:
        """The name of the tuning; several names are joined by "and"."""
        return self.tuning if isinstance(self.tuning, str) else " and ".join(self.tuning)

    def check(self) -> None:
        """Check also that `tuning`, `tunings` and the tuned sections are those of one run."""
        super().check()
        several = bool(self.tunings)
        require(
            self.tuning == list(self.tunings) if several else isinstance(self.tuning, str),
            f"tuning: {self.tuning} and the tunings of this run do not fit together; choose one by "
            "tuning=NAME, or several by tuning=[NAME,NAME]",
        )
        for name in self.tuned:
            require(
                (getattr(self, name) is None) == several,
                f"{name}: this key has no value; give it one",
            )


def refuse_tuned_keys(
    model: type[Config],
    overrides: Sequence[str],
    names: Sequence[str],
    listed: Mapping[str, object],
) -> None:
    """Raise `InputError` for an override of a key that several tunings set: it would change all.

    `names` are the run's tunings. A key that stands in `listed`, the tree's primary file, belongs
    to the run, also inside a tuned section. A key that does not exist is not refused here.
    """
    for override in overrides:
        key = override.partition("=")[0].lstrip("+~")
        changed = [k for k in list_keys(model) if f"{k}.".startswith(f"{key}.")]
        tuned = [k for k in changed if k.split(".")[0] in model.tuned]
        if not all(holds(listed, k.split(".")) for k in tuned):
            raise InputError(
                f"{key}: this would change several tunings ({', '.join(names)}); choose one, e.g. "
                f"{GROUP}={names[0]}"
            )


def join(composed: Mapping[str, Mapping[str, object]], tuned: Sequence[str]) -> dict[str, object]:
    """Join the configurations of several tunings, which set the sections `tuned`, to one.

    `composed` maps the name of the tuning's file to the configuration as plain data. The result has
    the keys that belong to no tuning; `tuning`, the list of the tunings' names; and `tunings`, the
    tuned sections by name. Raise `InputError` if two tunings have one name, or differ in keys that
    do not belong to a tuning.
    """
    first = next(iter(composed))
    common = _leave_out(composed[first], tuned)
    sections: dict[str, object] = {}
    for file, plain in composed.items():
        name = str(plain.get(GROUP))
        require(
            name not in sections,
            f"{GROUP}: two of the files {', '.join(composed)} set {GROUP}: {name}; give each its "
            "own name",
        )
        sections[name] = {key: value for key, value in plain.items() if key in tuned}
        differing = [
            key for key, value in _leave_out(plain, tuned).items() if common.get(key) != value
        ]
        require(
            not differing,
            f"{GROUP}: {first} and {file} differ in {', '.join(differing)}, which belongs to the "
            "run and not to a tuning; run them one at a time",
        )
    return {**common, GROUP: list(sections), SECTIONS: sections}


def _leave_out(plain: Mapping[str, object], tuned: Sequence[str]) -> dict[str, object]:
    return {key: value for key, value in plain.items() if key not in (*tuned, GROUP)}


def holds(mapping: object, path: Sequence[str]) -> bool:
    """Return whether nested mappings contain a key, split at its dots."""
    for part in path:
        if not isinstance(mapping, dict) or part not in mapping:
            return False
        mapping = mapping[part]
    return True
