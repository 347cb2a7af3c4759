"""What is run to judge the paper's statements and the study's goals, and the scores of records."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import pandas as pd

from experiments.mehammer2018.cells import PLANES, score_plane
from experiments.mehammer2018.scenarios import Scenario, run_composed
from experiments.mehammer2018.scores import score
from owtsweep.io.steps import tell_step

#: Noise that hardly counts, in dB.
SILENT = 120.0
#: The paper prints no Q. Where nothing disturbs the plant, it can be next to nothing. Where it is
#: disturbed, noise of 65 dB moves it by as much as in the author's file (.12 m), and Q knows it.
_NO_Q, _LOSSES = ("filters.process_share=1e-6",), ("sensors.loss_every=100",)
_PRINTED = Scenario(("KF",), tuning="paper", printed=True)
_DISTURBED = replace(_PRINTED, words=("sensors.process_snr=65", "filters.process_share=5.6e-4"))
#: Sensors of a basin: .5 mm and .05 deg, accelerations and rates with 40 dB, a delay of 25 ms, by
#: which the printed filters predict.
_BASIN = ("sensors.sigma=[5e-4,5e-4,5e-4,.05,.05,.05]", "record.settling=2")
_AHEAD = ("filters.delay=declared", "filters.delay_declared=.025")
_DECAY = Scenario(("KF",), motion="decay", snr=40.0, delay=5.0, words=(*_BASIN, *_AHEAD))

#: The paper's tests. Section 3.1, virtual data: figures 3 to 6. Section 3.2, physical data: figures
#: 7 and 8, here the decay of a buoy with sensors fixed to it. "R next to nothing" is what the
#: author's files show.
PAPER = {
    "noise 10 dB": replace(_PRINTED, snr=10.0, words=_NO_Q),
    "disturbed, R right": _DISTURBED,
    "disturbed, R x 10": replace(_DISTURBED, believed=10.0),
    "delay of a step": replace(_PRINTED, snr=SILENT, delay=1.0),
    "no loss": replace(_PRINTED, schemes=("KF", "KF_STEADY")),
    "losses as zeros": replace(_PRINTED, schemes=("KF", "KF_STEADY"), words=_LOSSES),
    "decay, R next to nothing": replace(_DECAY, schemes=("KF", "KF_STEADY"), believed=1e-6),
    "decay": replace(_DECAY, schemes=("KF", "KF_CONSISTENT", "PASSIVE_OBSERVER")),
}

_HONEST = Scenario(("KF_CONSISTENT",))
#: Surge whose mean is 2.5 standard deviations.
_FAR = ("motion.freedoms.x.mean=8.75",)
#: Motion without waves: slow in all degrees of freedom but heave.
_SLOW = tuple(f"motion.freedoms.{name}.waves=0" for name in ("x", "y", "phi", "theta", "psi"))
_BODY = replace(_HONEST, schemes=("KF_CONSISTENT", "ERROR_STATE"), words=("sensors.frame=body",))
#: What the project's own goals are judged by: every scheme is told the truth.
OWN = {
    "10 dB": replace(_HONEST, snr=10.0),
    "20 dB": replace(_HONEST, schemes=("KF_CONSISTENT", "KF", "KF_STEADY")),
    "20 dB, slow": replace(_HONEST, words=_SLOW),
    "10 dB, slow": replace(_HONEST, snr=10.0, words=_SLOW),
    "20 dB, R x 10": replace(_HONEST, believed=10.0),
    "delay of 4, no noise": Scenario(
        ("KF_STEADY",), tuning="paper", snr=SILENT, delay=4.0,
        believed=10.0 ** (0.1 * (SILENT - 20.0)), words=("sensors.exact_inertial=true",),
    ),
    "delay of 4": replace(_HONEST, schemes=("KF_DELAY",), delay=4.0),
    "far": replace(_HONEST, words=_FAR),
    "far, losses known": replace(_HONEST, words=(*_FAR, *_LOSSES)),
    "far, losses as zeros": replace(
        _HONEST, words=(*_FAR, *_LOSSES, "filters.losses=as_printed")
    ),
    "roll 0.5 deg": replace(_BODY, words=(*_BODY.words, "grid.roll=[0.5]")),
    "roll 20 deg": replace(_BODY, words=(*_BODY.words, "grid.roll=[20]")),
    "roll 20 deg, first order": replace(
        _HONEST, words=(*_BODY.words, "grid.roll=[20]", "filters.attitude=small")
    ),
}  # fmt: skip
SCENARIOS = PAPER | OWN
#: Most records of each of the paper's tests: they scatter little, and those of the decay are long.
MOST = 20


def collect(
    replicates: Sequence[int], overrides: Sequence[str] = ()
) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Run all scenarios and the default maps; return the scores of both.

    Columns are those of `score_scenario` and of `cells.score_plane`. Records have the numbers
    `replicates` (of which the paper's tests take `MOST`), but those of maps. Scenarios run side by
    side, in as many processes as there are cores.
    """
    from joblib import Parallel, delayed

    jobs: list[Any] = [
        delayed(score_scenario)(name, replicates[:MOST], overrides) for name in PAPER
    ]
    jobs += [delayed(score_scenario)(name, replicates, overrides) for name in OWN]
    jobs += [delayed(score_plane)(plane, overrides) for plane in PLANES]
    tables = Parallel(n_jobs=-1, return_as="generator")(jobs)
    found = []
    for name, table in zip([*SCENARIOS, *PLANES], tables, strict=True):
        tell_step(f"{name}: judged")
        found.append(table)
    scores, cells = found[: len(SCENARIOS)], found[len(SCENARIOS) :]
    return pd.concat(scores, ignore_index=True), pd.concat(cells, ignore_index=True)


def score_scenario(name: str, replicates: Sequence[int], overrides: Sequence[str]) -> pd.DataFrame:
    """Return the scores of a scenario on all records.

    Columns: scenario, scheme, measure, replicate, value.
    """
    scenario = SCENARIOS[name]
    config = scenario.compose(overrides)  # once, not per record: it takes .1 s
    rows = [
        (name, scheme, measure, replicate, value)
        for replicate in replicates
        for scheme, outcome in run_composed(scenario, config, replicate).items()
        for measure, value in score(outcome).items()
    ]
    return pd.DataFrame(rows, columns=["scenario", "scheme", "measure", "replicate", "value"])
