"""The engine of the mating study: plans and runs blocks of records, draws what comes of it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace

import pandas as pd

from owtsweep.config import as_mapping
from owtsweep.config.grid import Records
from owtsweep.figures.drawings import Drawing
from owtsweep.results.status import UNABLE
from owtsweep.studies.base.blocks import Labels, Planned, PlanPart, explain, make_rows, plan_blocks
from owtsweep.studies.base.contest import WAIT
from owtsweep.studies.base.declaration import Judgement
from owtsweep.studies.base.engine import ContestEngine
from owtsweep.studies.base.schemes import NotFinite
from owtsweep.studies.base.study import ContestStudy
from owtsweep.studies.mating.config import MatingConfig
from owtsweep.studies.mating.contest import CONTEST
from owtsweep.studies.mating.joining import (
    configure_blade,
    configure_hub,
    estimate,
    find_estimated_motion,
    find_true_motion,
)
from owtsweep.studies.mating.measures import compare
from owtsweep.sweep.study import Block

#: Most records of a block.
MOST_RECORDS = 4
#: Time of a record of the blade and one of the hub with its scheme, s per sample, measured as the
#: blade study's.
RECORD = 8e-6
#: Keys of the other studies' configurations on which no number depends.
NOT_CONTENT = ("schemes", "results", "name", "experiment", "compute", "axes", "criterion", "tuning")


class MatingEngine(ContestEngine["MatingConfig"]):
    """The engine of the mating study, given the blade study, whose schemes and costs it has."""

    def __init__(self, blade: ContestStudy) -> None:
        costs = blade.contest().costs
        assert costs is not None  # the blade study has measured them
        super().__init__(replace(CONTEST, costs=costs._replace(record=RECORD)))
        self.blade = blade

    def rank(self, config: MatingConfig) -> Sequence[str]:
        return [*self.blade.scheme_table().rank(config)]

    def plan(self, config: MatingConfig, part: PlanPart | None = None) -> list[Block]:
        schemes = [Planned(name) for name in config.schemes]
        content = _describe_content(config)
        return plan_blocks(CONTEST, config, schemes, content, MOST_RECORDS, CONTEST.names, part)

    def run(
        self, config: MatingConfig, blocks: Sequence[Block]
    ) -> Iterator[tuple[Block, pd.DataFrame]]:
        """Run blocks of one group, i.e. of one cell and some records; yield each with its rows."""
        content = blocks[0].content
        schemes = list(dict.fromkeys(block.content["scheme"] for block in blocks))
        blade = configure_blade(config, content["sigma"], content["outage"], schemes)
        hub = configure_hub(config, content["hub_sigma"])
        hold = max(round(content["hold"] * config.record.rate), 1)
        replicates = range(*content["replicates"])
        judged: dict[str, list[Judgement[Mapping[str, float]]]] = {scheme: [] for scheme in schemes}
        for replicate in replicates:
            of_blade, of_hub = estimate(blade, replicate), estimate(hub, replicate)
            true = find_true_motion(of_blade, of_hub)
            for scheme in schemes:
                if scheme in of_blade.failures:
                    judged[scheme].append(Judgement(None, UNABLE, of_blade.failures[scheme]))
                    continue
                estimated = find_estimated_motion(of_blade, scheme, of_hub, config.hub_scheme)
                try:
                    found = compare(true, estimated, config.limits, hold, config.record.settled)
                except (NotFinite, ValueError) as error:
                    judged[scheme].append(explain(error))
                    continue
                if of_blade.latencies[scheme] > 0.0:
                    found[WAIT] = of_blade.latencies[scheme]
                judged[scheme].append(Judgement(found))
        for block in blocks:
            scheme = block.content["scheme"]
            labels = Labels(scheme, block.content, CONTEST.names, replicates)
            yield block, make_rows(labels, judged[scheme])

    def drawings(
        self,
        config: MatingConfig,
        tables: Mapping[str, pd.DataFrame],
        rows: pd.DataFrame,
        metadata: Mapping[str, str],
    ) -> dict[str, Drawing]:
        """Return the map of each criterion, and the map of chances."""
        from owtsweep.studies.mating.chances import list_figures

        figures = super().drawings(config, tables, rows, metadata)
        return {**figures, **list_figures(config, rows, metadata)}


def _describe_content(config: MatingConfig) -> dict[str, object]:
    """Return what the rows of every block depend on: both other configurations without a cell."""
    grid = config.grid
    blade = as_mapping(configure_blade(config, grid.sigma[0], grid.outage[0], config.schemes[:1]))
    hub = as_mapping(configure_hub(config, grid.hub_sigma[0]))
    for other, axes in ((blade, ("sigma", "outage")), (hub, ())):
        for name in (*Records.model_fields, *axes):
            other["grid"].pop(name)
        for name in NOT_CONTENT:
            other.pop(name, None)
    hub["sensors"]["gnss"].pop("sigma")
    blade.pop("tune")
    return {
        "limits": as_mapping(config)["limits"],
        "blade": blade,
        "hub": hub,
        "hub_scheme": config.hub_scheme,
    }
