"""The engine `expected`: plans the work of a study without records, and makes the study's rows.

A block is one scheme at all natural periods. Most of the time goes into the curves of a scheme,
which do not depend on the period. SKF has other gains at each amplitude, so it has a block for
each; see `expected.spectral`.
"""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pandas as pd

from owtsweep.results.status import FAILED, OK
from owtsweep.studies.hub import measures
from owtsweep.studies.hub import sensors as sensing
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.contract import SCHEMES, resolve_all
from owtsweep.studies.hub.error_curves.of_schemes import (
    EXPECTED_VERSION,
    curves_of,
    motion_of,
    noise_of,
)
from owtsweep.studies.hub.expected.spectral import AXES, MEASURES, make_rows
from owtsweep.studies.hub.known_motion import RECORDS, factor_at, ladder
from owtsweep.studies.hub.worlds import list_content
from owtsweep.sweep.study import Block


def plan(config: HubConfig) -> list[Block]:
    """Return the blocks of a study: one per scheme, but one per amplitude for SKF."""
    shared = list_content(config)
    if config.normalise == "peak":
        shared["peak_records"] = RECORDS
    else:
        del shared["seed"]  # there is no record, so nothing is random
    periods = sorted(float(period) for period in config.grid.natural_period)
    blocks = []
    entries = SCHEMES.list_entries(config)
    for entry, scheme in zip(entries, resolve_all(entries, config), strict=True):
        content = {
            **shared,
            **SCHEMES.describe_content(config, entry, scheme),
            "expected_version": EXPECTED_VERSION,
            "natural_periods": periods,
        }
        recompute, cells = SCHEMES.explain_recompute(scheme), len(periods)
        if not scheme.expected_in_cell:
            cells *= len(config.grid.amplitude)
            label = f"{scheme.name}, expected"
            blocks.append(Block(scheme.name, label, content, cells, cells, recompute))
            continue
        for amplitude in map(float, config.grid.amplitude):
            name, of_cell = f"{scheme.name}, {amplitude:g} m", {**content, "amplitude": amplitude}
            blocks.append(Block(name, f"{name}, expected", of_cell, cells, recompute=recompute))
    return blocks


def run(config: HubConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Compute the rows of some blocks; yield each block with its rows."""
    for block in blocks:
        chosen, periods = block.choose(config), block.content["natural_periods"]
        if "amplitude" in block.content:
            yield block, make_rows(chosen, periods, block.content["amplitude"])
        else:
            yield block, rows(chosen, block.content["scheme"], periods)


def rows_of(config: HubConfig, names: Sequence[str], periods: Sequence[float]) -> pd.DataFrame:
    """Compute the `rows` of several schemes at natural periods (s), in threads on all cores."""
    with ThreadPoolExecutor(os.cpu_count() or 1) as pool:
        if config.normalise == "peak":
            for rung in ladder(config, periods):  # ready by the time that the rows need them
                pool.submit(factor_at, config, rung)
        # The slowest schemes are usually listed last. They are started first, so that no core is
        # idle at the end.
        parts = list(pool.map(lambda name: rows(config, name, periods), names[::-1]))
    return pd.concat(parts[::-1], ignore_index=True)


def rows(config: HubConfig, name: str, periods: Sequence[float]) -> pd.DataFrame:
    """Compute the rows of a scheme: one row per natural period (s), measure and window.

    A row has the mean square error due to motion of 1 m, the mean square error due to noise, and 0
    as the mean product of the two errors. Each further natural period costs only a sum over the
    scheme's curves. If an error is not finite, there is one row with the status "failed".
    """
    sensors = sensing.sensors(config.sensors)
    curve = curves_of(config, name)
    motion = motion_of(config, curve, periods)
    noise = noise_of(config, sensors, curve)
    angle = np.deg2rad(config.wave_direction)
    along = (np.cos(angle) ** 2, np.sin(angle) ** 2)
    steps = round(config.record.duration / sensors.step)
    samples = (steps, steps - config.measures.find_settled(sensors.step))
    parts = []
    for m, measure in enumerate(MEASURES):
        for w, window in enumerate(measures.WINDOWS):
            floors = (noise[0, m, w], noise[1, m, w], noise[0, m, w] + noise[1, m, w])
            labels = (*AXES[measure], measure)
            for label, share, floor in zip(labels, (*along, 1.0), floors, strict=True):
                columns = {
                    "natural_period": np.asarray(periods, dtype=float),
                    "measure": label,
                    "window": window,
                    "motion": share * motion[:, m, w],
                    "noise": floor,
                    "n_samples": samples[w],
                }
                parts.append(pd.DataFrame(columns))
    table = pd.concat(parts, ignore_index=True)
    finite = bool(np.all(np.isfinite(table[["motion", "noise"]].to_numpy())))
    table = table.assign(
        replicate=0,
        scheme=name,
        amplitude=np.nan,
        cross=0.0,
        value=np.nan,
        status=OK if finite else FAILED,
        reason="" if finite else "the estimate is not finite",
    )
    if not finite:
        table = table.iloc[:1]
    return table.astype({"replicate": "int64", "n_samples": "int64"})
