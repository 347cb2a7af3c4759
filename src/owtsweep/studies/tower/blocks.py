"""Plans and runs the blocks of the tower study: one record, noise, soil and scheme each."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import groupby
from typing import Any

import pandas as pd

from owtsweep.config import as_mapping
from owtsweep.io.reading import expand_home, hash_file
from owtsweep.results.status import OK, UNABLE
from owtsweep.studies.tower.believed import make_believed
from owtsweep.studies.tower.case import Case, list_channels, make_case, measure
from owtsweep.studies.tower.config import TowerConfig
from owtsweep.studies.tower.contract import DIRECTIONS, Channel, Prepared, Scheme, Unable
from owtsweep.studies.tower.measures import WINDOW, compare, find_quietest, find_true_fatigue
from owtsweep.studies.tower.recorded_truth import measure as compare_with_record
from owtsweep.studies.tower.schemes import resolve, resolve_all
from owtsweep.studies.tower.setting import make_setting
from owtsweep.studies.tower.sight import require_sight
from owtsweep.sweep.study import Block

#: Keys and sections of the configuration on which every row depends, beside the cuts.
SHARED = (
    "seed", "structure", "record", "truth", "recorded", "wind", "waves", "sensors", "faults",
    "filters", "model", "fatigue",
)  # fmt: skip


def plan(config: TowerConfig) -> list[Block]:
    """Return all blocks of a configuration, at whose sensors some scheme can work.

    There is one block per replicate, noise, scheme, and soil factor. A scheme that does not know
    the soil has one block for all soil factors. The blocks of a replicate are a group: truth and
    measurements are made once for them.
    """
    require_sight(config)
    shared = _describe_content(config)
    schemes = resolve_all(config.schemes)
    every = len(config.grid.soil_factor)
    blocks = []
    for replicate in range(config.grid.replicates):
        for noise in config.grid.noise:
            for scheme in schemes:
                of_case = {"replicate": replicate, "noise": noise, "scheme": scheme.name}
                told = f"{scheme.name}, {noise:g} %"
                group = f"replicate {replicate}"
                if not scheme.knows_soil:
                    label = f"{told}, {group}"
                    blocks.append(Block(group, label, shared | of_case, every, every))
                    continue
                for factor in config.grid.soil_factor:
                    content = shared | of_case | {"soil_factor": factor}
                    blocks.append(Block(group, f"{told}, soil x {factor:g}, {group}", content, 1))
    return blocks


def run(config: TowerConfig, blocks: Sequence[Block]) -> Iterator[tuple[Block, pd.DataFrame]]:
    """Run blocks of one group, i.e. of one replicate; yield each with its rows.

    The truth is made once, also for several tunings; measurements are made once per noise.
    """
    case = make_case(config, blocks[0].content["replicate"])
    recorded = config.recorded.file is not None  # a record has stresses nowhere
    true_fatigue = {} if recorded else find_true_fatigue(config, case)
    for noise, of_noise in groupby(blocks, lambda block: block.content["noise"]):
        channels = {d: list_channels(config, case, d, noise) for d in case.motion}
        measured = {d: measure(config, case, d, channels[d]) for d in case.motion}
        for block in of_noise:
            chosen = block.choose(config)
            scheme = resolve(block.content["scheme"])
            # A scheme that does not know the soil is told the right one.
            factor = block.content.get("soil_factor", 1.0)
            try:
                estimates = {
                    d: prepare(chosen, case, d, factor, channels[d], scheme).run(measured[d])
                    for d in case.motion
                }
            except Unable as reason:
                yield block, _tell(block, {"": float("nan")}, UNABLE, str(reason))
                continue
            if recorded:
                found = compare_with_record(
                    case.motion, estimates, case.part.cut, config.record.settled
                )
            else:
                found = compare(chosen, case, true_fatigue, estimates)
            found |= find_quietest(channels.get(DIRECTIONS[0], []))
            yield block, _tell(block, found, OK, "")


def _describe_content(config: TowerConfig) -> dict[str, Any]:
    """Return what the rows of every block depend on, without names."""
    whole = as_mapping(config)
    content = {name: whole[name] for name in SHARED}
    for section, names in (("structure", ("name", "source")), ("sensors", ("name",))):
        content[section] = {k: v for k, v in content[section].items() if k not in names}
    content["cuts"] = list(config.heights)
    if config.wind.file is not None:
        content["loads"] = hash_file(expand_home(config.wind.file))
    if config.recorded.file is not None:
        content["recorded"] |= {"file": hash_file(expand_home(config.recorded.file))}
    return content


def prepare(
    config: TowerConfig,
    case: Case,
    direction: str,
    soil_factor: float,
    channels: Sequence[Channel],
    scheme: Scheme,
) -> Prepared:
    """Make a scheme ready for one direction.

    Raises
    ------
    Unable
        If the scheme cannot work there.
    """
    believed = make_believed(config.filters, 1.0 / config.record.rate, case.motion[direction])
    setting = make_setting(config, case.part, direction, soil_factor, channels, believed)
    return scheme.prepare(setting)


def _tell(block: Block, found: dict[str, float], status: str, reason: str) -> pd.DataFrame:
    """Return the rows of a block, one per measure; a row without soil factor has NaN there."""
    content = block.content
    return pd.DataFrame(
        {
            "noise": float(content["noise"]),
            "soil_factor": float(content.get("soil_factor", float("nan"))),
            "scheme": content["scheme"],
            "replicate": content["replicate"],
            "measure": list(found),
            "window": WINDOW if status == OK else "",
            "value": list(found.values()),
            "status": status,
            "reason": reason,
        }
    )
