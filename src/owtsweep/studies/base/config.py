"""What the configurations of declared studies share: a user's schemes among the study's own."""

from __future__ import annotations

from typing import Any

from owtsweep.config.tuned import TunedConfig
from owtsweep.studies.base.schemes import list_names, stand_in


class ContestConfig(TunedConfig):
    """A configuration with the key `schemes`, which the study declares among its own."""

    schemes: list[Any]

    def describe_code(self) -> Any:
        """Return the names of all schemes: a user's class is not made when a run is read."""
        return list_names(self.schemes)

    @classmethod
    def hide_code(cls, plain: dict[str, Any], described: Any) -> dict[str, Any]:
        """Return the keys of a stored run with a stand-in for each user's scheme."""
        return {**plain, "schemes": stand_in(plain.get("schemes"), described)}
