"""What the expected engine cannot do, in one line each."""

from __future__ import annotations

from typing import TYPE_CHECKING

from owtsweep.config import require
from owtsweep.studies.hub.schemes import resolve_all

if TYPE_CHECKING:
    from owtsweep.studies.hub.config import HubConfig


def check(config: HubConfig) -> None:
    """Raise `InputError` for what has no expectation here."""
    require(
        not config.measures.extremes,
        "measures.extremes: largest errors need records; use engine=batch",
    )
    require(
        config.evaluation == "superposed",
        "evaluation: engine=expected runs no record, so there is nothing to run directly; use "
        "evaluation=superposed, or engine=batch",
    )
    for scheme in resolve_all(config.schemes, config):
        require(
            scheme.linear and hasattr(scheme, "kernel"),
            f"schemes: {scheme.name} has no kernel (linear, with gains that no data change), from "
            "which engine=expected computes; use engine=batch for it, or set hme.mhe.constraints "
            "to null if it has any",
        )
