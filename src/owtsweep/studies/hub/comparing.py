"""Describes a run of the hub study for a comparison of runs."""

from __future__ import annotations

from owtsweep.comparing.comparison import Aspects, Candidate
from owtsweep.studies.hub.conditions import BOUNDARY, get_conditions, get_grid
from owtsweep.studies.hub.config import HubConfig
from owtsweep.studies.hub.engines import ENGINES
from owtsweep.studies.hub.expected import answers
from owtsweep.studies.hub.names import list_baselines
from owtsweep.studies.hub.origin import list_origin
from owtsweep.studies.hub.plant import describe_content, is_plant
from owtsweep.studies.hub.resolving import scheme_names

#: The keys on which a record's motion depends, besides natural period and replicate. Changing
#: sigma, delay, rate, bias or tuning changes neither the motion's phases nor the draws of the
#: noise.
PAIRING = ("seed", "record", "spectrum", "band", "normalise")
#: These keys with motion=plant, besides the plant itself.
PAIRING_OF_PLANT = ("seed", "record")


def describe_run(run: Candidate) -> Aspects:
    """Describe a run of the hub study for a comparison of runs.

    The description has the run's conditions, grid, schemes and criterion, and the settings that two
    runs must share so that their records can be paired.
    """
    config: HubConfig = run.config
    window = config.measures.window
    samples = ENGINES[config.engine]().samples
    pairing = {key: getattr(config, key) for key in PAIRING}
    if is_plant(config):
        pairing = {key: getattr(config, key) for key in PAIRING_OF_PLANT} | describe_content(config)
    return Aspects(
        conditions=get_conditions(config),
        grid=get_grid(config),
        schemes=scheme_names(config),
        criterion=config.measures.criterion,
        window=window,
        pairing=pairing,
        boundary=None if is_plant(config) else BOUNDARY,
        origin=list_origin(config),
        beside=list_baselines(config),
        best_of=None
        if samples
        else lambda rows, grid, schemes, criterion: answers.best_scheme(
            rows, schemes, [criterion], grid, window
        ),
    )
