"""What the hub study's tests share: small configurations, records, and both engines on them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from copy import deepcopy
from dataclasses import replace
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from omegaconf import OmegaConf

from owtsweep.config import Config, Plain, as_mapping
from owtsweep.studies import compose, make_config
from owtsweep.studies.base.blocks import DeclaredBlocks
from owtsweep.studies.hub import estimates
from owtsweep.studies.hub.chain import Chain
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import Estimator, Known, Scheme
from owtsweep.studies.hub.engines import find_declaration
from owtsweep.studies.hub.records import Records, make_records
from owtsweep.studies.hub.sensors import Measured, Sensors, observe
from owtsweep.sweep.study import Block

Array = NDArray[np.float64]

#: Low rates and short windows: everything that the default study has, in some hundred steps.
SMALL = (
    "experiment=study",
    "tuning=paper",
    "sensors.imu.rate=20",
    "sensors.gnss.rate=2",
    "sensors.yaw=37",
    "sensors.gravity=[0.2,-0.1]",
    "hme.smoother_window=5",
    "hme.mhe.horizon=4",
    "hme.mhe.interval=0.1",
    "record.duration=30",
    "measures.settling_time=5",
    "grid.natural_period=[4.0]",
    "grid.amplitude=[0.05,0.7,10.0]",
    "grid.replicates=1",
    "baselines=[]",
)


@cache
def _small(tuning: str) -> dict[str, Any]:
    return as_mapping(compose([*SMALL, f"tuning={tuning}"]))


def configure(*overrides: str, tuning: str = "paper") -> HubConfig:
    """The configuration of `SMALL`, a tuning and overrides (composed once per tuning: .2 s)."""
    config = from_mapping(lay_over(_small(tuning), overrides))
    assert isinstance(config, HubConfig)
    return config


def lay_over(plain: Plain, overrides: Sequence[str]) -> Plain:
    """The keys of a configuration with overrides, as plain data: OmegaConf's merge takes .03 s."""
    given = OmegaConf.to_container(OmegaConf.from_dotlist(list(overrides)))
    return _merge(deepcopy(plain), given)


def _merge(below: Any, above: Any) -> Any:
    if not (isinstance(below, dict) and isinstance(above, dict)):
        return above
    return below | {key: _merge(below.get(key), value) for key, value in above.items()}


def from_mapping(plain: Plain) -> Config:
    """The configuration of these keys."""
    return make_config(plain, plain["study"])


def whole_series(records: Records, amplitude: float, index: int = 0) -> Measured:
    """What the sensors report of one replicate, specific force in the IMU's frame."""
    signal = observe(records.motion[index], records.direction, records.sensors)
    return signal.add_noise(amplitude, records.noise[index])


def measured(config: HubConfig, amplitude: float = 0.7) -> tuple[Measured, Sensors]:
    """Sensor data of the first replicate at the first natural period."""
    records = make_records(config, config.grid.natural_period[0], [0])
    return whole_series(records, amplitude), records.sensors


def ned(measurements: Measured, sensors: Sensors) -> tuple[Array, Array]:
    """Lanes of the batch engine: specific force and fixes in NED, (steps, 2) and (fixes, 2)."""
    return measurements.specific_force @ sensors.rotation.T, measurements.fixes


class Run(NamedTuple):
    """One engine on one series.

    state (steps, 4): estimate of now; filtered (steps, 8) and covariance (steps, 8, 8): the
    filter's own; reported (steps, 4, 4): the estimate's covariance; innovation (steps, 2), its
    variance (steps,), NaN where there is none.
    """

    state: Array
    filtered: Array
    covariance: Array
    reported: Array
    innovation: Array
    innovation_variance: Array


def run_batch(scheme: Scheme, config: HubConfig, data: Measured, sensors: Sensors) -> Run:
    """The batch engine on one series, with what its filter holds inside."""
    chain: Chain = scheme.kernel(Known(sensors, config), len(data.specific_force))
    force, fixes = ned(data, sensors)
    position, velocity, innovation = estimates.trajectories(chain, force, fixes)
    gains = chain.gains
    row = gains.row(np.arange(len(force)))
    fresh = gains.fresh[row]
    return Run(
        state=np.hstack([position, velocity]),
        filtered=filtered_states(chain, force, fixes),
        covariance=np.kron(gains.filtered[row], np.eye(2)),
        reported=np.kron(chain.covariance[row], np.eye(2)),
        innovation=np.where(fresh[:, None], innovation, np.nan),
        innovation_variance=np.where(fresh, gains.innovation_variance[row], np.nan),
    )


def run_reference(scheme: Scheme, config: HubConfig, data: Measured, sensors: Sensors) -> Run:
    """A loop over `update` of one of our schemes, looking into its filter."""
    estimator: Any = scheme.start(Known(sensors, config))
    kf = (estimator.chain if hasattr(estimator, "chain") else estimator).filter.kf
    steps = len(data.specific_force)
    run = Run(
        *(np.full((steps, *shape), np.nan) for shape in ((4,), (8,), (8, 8), (4, 4), (2,), ()))
    )
    for k, force in enumerate(data.specific_force):
        M = sensors.fix_interval
        estimate = estimator.update(force, data.fixes[k // M] if k % M == 0 else None)
        run.state[k] = *estimate.position, *estimate.velocity
        run.filtered[k] = kf.x[:, 0]
        run.covariance[k], run.reported[k] = kf.P, estimate.covariance
        if estimate.innovation is not None:
            run.innovation[k], S = estimate.innovation
            run.innovation_variance[k] = S[0, 0]
            np.testing.assert_allclose(S, S[0, 0] * np.eye(2), rtol=1e-9, atol=1e-9 * S[0, 0])
    return run


def filtered_states(chain: Chain, force: Array, fixes: Array) -> Array:
    """The filter's states over a record, (steps, 4 x lanes), without a smoother."""
    unsmoothed = replace(chain, filter=chain.filter._replace(window=0))
    return estimates.states(unsmoothed, force, fixes).reshape(len(force), -1)


def assert_same(actual: Array, expected: Array, what: str, tolerance: float = 1e-9) -> None:
    """Column by column: |difference| <= tolerance x that state's largest magnitude."""
    largest = np.max(np.abs(expected), axis=0)
    difference = np.max(np.abs(actual - expected), axis=0)
    assert np.all(difference <= tolerance * largest), f"{what}: {difference} of {largest}"


class Key(NamedTuple):
    """What identifies a row; `amplitude` is None for a superposed one."""

    natural_period: float
    scheme: str
    measure: str
    window: str
    amplitude: float | None
    replicate: int


def plan_blocks(config: HubConfig) -> list[Block]:
    """The blocks of a configuration that runs records."""
    return DeclaredBlocks(find_declaration(config)).plan(config)


def run_blocks(
    config: HubConfig, of_group: Sequence[Block]
) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of one group; each with its rows."""
    return DeclaredBlocks(find_declaration(config)).run(config, of_group)


def rows_of(config: HubConfig) -> dict[Key, dict[str, Any]]:
    """All rows of a study; none may have failed."""
    table = {}
    plan = plan_blocks(config)
    for group in dict.fromkeys(block.group for block in plan):
        for _, rows in run_blocks(config, [block for block in plan if block.group == group]):
            for row in rows.to_dict("records"):
                assert row["status"] == "ok", row["reason"]
                if np.isnan(row["amplitude"]):
                    row["amplitude"] = None
                table[Key(*(row[field] for field in Key._fields))] = row
    return table


class Streaming(Scheme):
    """A scheme whose `start` makes its online form."""

    def __init__(self, scheme: Scheme) -> None:
        self.name, self.linear, self.knows_motion = scheme.name, scheme.linear, scheme.knows_motion
        self.scheme = scheme

    def start(self, known: Known) -> Estimator:
        return self.scheme.stream(known)
