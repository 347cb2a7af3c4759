"""What is run to judge the paper's statements, and the scores of several records of it."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from owtsweep.studies.tower.paper.scenarios import SETUPS, Scenario, run_scenarios
from owtsweep.studies.tower.paper.scores import tabulate

if TYPE_CHECKING:
    import pandas as pd

#: Case study 1 with the set-ups of Table 2.
WIND = {name: Scenario(name) for name in SETUPS}
#: The same, with loads' statistics from the truth.
MATCHED = {name: Scenario(name, tuning="matched") for name in SETUPS}
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
    ACCELEROMETERS,
    GNSS,
    *WEIGHTLESS.values(),
    *WAVES.values(),
)


def collect(replicates: Sequence[int], overrides: Sequence[str] = ()) -> pd.DataFrame:
    """Run all scenarios on records with these numbers; return the scores (see `tabulate`)."""
    import pandas as pd

    tables = []
    for replicate in replicates:
        results = run_scenarios(ALL, replicate, overrides)
        tables.append(tabulate([o for each in results.values() for o in each.values()]))
    return pd.concat(tables, ignore_index=True)
