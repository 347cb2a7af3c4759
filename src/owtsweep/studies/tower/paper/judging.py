"""What is run to judge the paper's statements, and the scores of several records of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.io.steps import tell_step
from owtsweep.studies.tower.paper.scenarios import SETUPS, Scenario, run_scenarios
from owtsweep.studies.tower.paper.scores import tabulate

if TYPE_CHECKING:
    import pandas as pd

#: Case study 1 with the set-ups of Table 2.
WIND = {name: Scenario(name) for name in SETUPS}
#: The same, with loads' statistics from the truth.
MATCHED = {name: Scenario(name, tuning="matched") for name in SETUPS}
#: A model that knows its weight: rotations and damage with the declared loads, and with the true
#: ones where few sensors leave much to the loads' statistics.
WEIGHED = {name: Scenario(name, weight=True) for name in SETUPS}
WEIGHED_MATCHED = Scenario("sparse_theta_a", weight=True, tuning="matched")
#: Accelerometers only, and one displacement sensor more, in case study 1.
ACCELEROMETERS = Scenario("accelerometers")
GNSS = Scenario("sparse_gnss")
#: Case study 1 in a world without gravity.
WEIGHTLESS = {name: Scenario(name, gravity=False) for name in ("dense_theta_a", "sparse_theta_a")}
#: Case study 2: yaw of the waves in degrees, and input vector -> scenario.
WAVES = {
    (yaw, inputs): Scenario(sea=sea, scheme=scheme)
    for yaw, sea in ((0, "waves"), (30, "waves_30"))
    for inputs, scheme in (("p_1", "AKF"), ("p_2", "AKF_WAVE"))
}
ALL = (
    *WIND.values(),
    *MATCHED.values(),
    *WEIGHED.values(),
    WEIGHED_MATCHED,
    ACCELEROMETERS,
    GNSS,
    *WEIGHTLESS.values(),
    *WAVES.values(),
)


def collect(replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Run all scenarios on records with these numbers; return the scores (see `tabulate`).

    Records run side by side, in as many processes as there are cores; each needs up to 1 GB.
    """
    import pandas as pd
    from joblib import Parallel, cpu_count, delayed

    workers = min(cpu_count(), len(replicates))
    tables = Parallel(n_jobs=workers, return_as="generator")(
        delayed(_score)(replicate, overrides) for replicate in replicates
    )
    found = []
    for replicate, table in zip(replicates, tables, strict=True):
        tell_step(f"record {replicate}: judged")
        found.append(table)
    return pd.concat(found, ignore_index=True)


def _score(replicate: int, overrides: Sequence[str]) -> pd.DataFrame:
    """Return the scores of one record; estimates of one scenario at a time are in memory."""
    import pandas as pd

    tables = [
        tabulate(list(outcomes.values()))
        for _, outcomes in run_scenarios(ALL, replicate, overrides)
    ]
    return pd.concat(tables, ignore_index=True)
