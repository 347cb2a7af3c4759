"""Fixtures for all tests."""

from __future__ import annotations

import pytest


@pytest.fixture(scope="session")
def kernels() -> None:
    """Compile the hub study's kernels (or load them from numba's cache) once per session."""
    from owtsweep.studies import compose
    from owtsweep.studies.base import blocks
    from owtsweep.studies.hub.declaration import find_declaration

    small = [
        "grid.natural_period=[4.0]", "grid.amplitude=[1.0]", "grid.replicates=1",
        "record.duration=10", "measures.settling_time=1", "sensors.imu.rate=20",
        "schemes=[HME1]", "tuning=matched",
    ]  # fmt: skip
    for evaluation in ("superposed", "direct"):
        config = compose([*small, f"evaluation={evaluation}"])
        declaration = find_declaration(config)  # type: ignore[arg-type]
        for _ in blocks.run(declaration, config, blocks.plan(declaration, config)):
            pass
