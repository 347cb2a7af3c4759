"""One motion-only and one noise-only run serve every amplitude: direct against superposed."""

from __future__ import annotations

import math

import pytest
from tools import Key, configure, rows_of

from owtsweep.studies.hub.config import HubConfig

pytestmark = pytest.mark.usefixtures("kernels")

TINY = ("record.duration=8", "measures.settling_time=3", "grid.amplitude=[0.2,3.0]")
MEASURES = ("x", "y", "vx", "vy", "position", "velocity", "nees", "nis")


def expanded(config: HubConfig) -> dict[Key, float]:
    """Values at every amplitude: N^2 motion + 2 N cross + noise."""
    return {
        key._replace(amplitude=N): N**2 * row["motion"] + 2 * N * row["cross"] + row["noise"]
        for key, row in rows_of(config).items()
        for N in config.grid.amplitude
    }


@pytest.mark.parametrize(
    ("engine", "changes"),
    [("batch", ("grid.replicates=3",)), ("reference", TINY)],
)
@pytest.mark.parametrize("tuning", ["paper", "matched"])
def test_direct_is_superposed(engine: str, changes: tuple[str, ...], tuning: str) -> None:
    common = (*changes, f"engine={engine}")
    superposed = expanded(configure(*common, tuning=tuning))
    config = configure(*common, "evaluation=direct", tuning=tuning)
    direct = {key: row["value"] for key, row in rows_of(config).items()}
    cases = 4 * len(MEASURES) * 2 * len(config.grid.amplitude) * config.grid.replicates
    assert len(direct) == len(superposed) == cases
    for key, value in direct.items():
        assert superposed[key] == pytest.approx(value, rel=1e-9), key


def test_the_loop_writes_the_rows_of_the_batch_engine() -> None:
    batch = rows_of(configure(*TINY))
    loop = rows_of(configure(*TINY, "engine=reference"))
    assert batch.keys() == loop.keys()
    for key, row in batch.items():
        other = loop[key]
        assert row["n_samples"] == other["n_samples"], key
        scale = max(row["motion"], row["noise"])
        for product in ("motion", "cross", "noise"):
            assert row[product] == pytest.approx(other[product], rel=1e-8, abs=1e-9 * scale), key
        assert math.isnan(row["value"])
