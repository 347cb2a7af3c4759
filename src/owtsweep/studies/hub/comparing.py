"""Describes a run of the hub study for a comparison of runs."""

from __future__ import annotations

from owtsweep.comparing.comparison import Aspects, Candidate
from owtsweep.studies.hub.conditions import find_world, get_conditions, get_grid
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.describe import list_origin
from owtsweep.studies.hub.engines import ENGINES
from owtsweep.studies.hub.expected import answers
from owtsweep.studies.hub.listed import list_baselines, scheme_names


def describe_run(run: Candidate) -> Aspects:
    """Describe a run of the hub study, and what two runs must share so that records are paired."""
    config: HubConfig = run.config
    window = config.measures.window
    samples = ENGINES[config.engine](find_world(config)).samples
    world = find_world(config)
    # sigma, delay, rate, bias and tuning change neither the motion's phases nor the draws of noise
    pairing = {"seed": config.seed, "record": config.record, **world.list_pairing(config)}
    return Aspects(
        conditions=get_conditions(config),
        grid=get_grid(config),
        schemes=scheme_names(config),
        criterion=config.measures.criterion,
        window=window,
        pairing=pairing,
        boundary=world.boundary,
        origin=list_origin(config),
        beside=list_baselines(config),
        best_of=None
        if samples
        else lambda rows, grid, schemes, criterion: answers.best_scheme(
            rows, schemes, [criterion], grid, window
        ),
    )
