"""Describes where a run's numbers come from, for titles and messages."""

from __future__ import annotations

from typing import Any

from owtsweep.studies.base.contest import Contest


def describe_draws(config: Any) -> str:
    """Return in words how many records a cell has, and their seed."""
    count = config.grid.replicates
    return f"{count} record{'s' * (count != 1)} per cell, seed {config.seed}"


def describe_origin(contest: Contest, config: Any) -> str:
    """Return in one line the tuning, the truth, the sensors, the records and their seed."""
    told = list_origin(contest, config)
    return (
        f"Tuning {told['tuning']}; truth: {told['truth']}; sensors: {told['sensors']}; "
        f"{describe_draws(config)}"
    )


def list_origin(contest: Contest, config: Any) -> dict[str, str]:
    """Return what a reader must know of a run: its name -> in words."""
    return {
        "tuning": config.tuning_name,
        "truth": contest.describe_truth(config),
        "sensors": contest.describe_sensors(config),
        "records per cell": str(config.grid.replicates),
        "seed": str(config.seed),
    }
