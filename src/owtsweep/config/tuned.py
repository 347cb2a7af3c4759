"""A configuration whose tuned sections may be those of one tuning, or of several."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from pydantic import SerializerFunctionWrapHandler, model_serializer

from owtsweep.config.common import Config
from owtsweep.errors import require

#: The value of a key that stands in `tunings.<name>`.
ABSENT: Any = None


class TunedConfig(Config):
    """A configuration with the keys `tuning` and `tunings`, and the sections `tuned`.

    With several tunings, `tuning` is the list of their names, `tunings` holds their sections, and
    the sections `tuned` are absent. `by_tuning` gives the configuration of each. The study declares
    all these keys, each where it stands among its own.
    """

    if TYPE_CHECKING:
        tuning: Any
        tunings: Any

    @model_serializer(mode="wrap")
    def _leave_out_absent_keys(self, dump: SerializerFunctionWrapHandler) -> dict[str, Any]:
        absent = self.tuned if self.tunings else ("tunings",)
        return {name: value for name, value in dump(self).items() if name not in absent}

    @property
    def tuning_name(self) -> str:
        """The name of the tuning; several names are joined by "and"."""
        return self.tuning if isinstance(self.tuning, str) else " and ".join(self.tuning)

    def check(self) -> None:
        """Check also that `tuning`, `tunings` and the tuned sections are those of one run.

        Raises
        ------
        InputError
            If names and sections do not fit together, or a tuned section is missing; also as
            `Config.check`.
        """
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
