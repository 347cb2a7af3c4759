"""Choose inclinometers for the IEA-15 turbine without a record, and check the choice on records.

    python -m experiments.tower.placement [FOLDER] [OVERRIDE ...]

writes into FOLDER (default: results/tower_placement)

- choices.csv: the sets of 3 to 5 inclinometers that are chosen one by one, and the best of all
  sets, with the predicted errors of stress and M0 (AKF, fore-aft), beside the accelerometers of
  the set-up sparse_theta_a;
- checked.csv: predicted and simulated errors of these sets, of Table 2's, and of some at random;
- placement_stress.png, placement_moment.png: what each further inclinometer buys, and where the
  next one pays, if the stress at the worst weld or M0 counts.

An OVERRIDE is one of the tower study's keys, e.g. record.duration=700.
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import spearmanr

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.studies.composing import compose
from owtsweep.studies.tower.figures.placement import draw_placement
from owtsweep.studies.tower.placement import (
    Choice,
    Criterion,
    choose_exhaustively,
    choose_greedily,
    predict,
)
from owtsweep.studies.tower.placement_case import PlacementCase, make_case, simulate

SET_UP = ("sensors=accelerometers", "grid.noise=[1]", "record.duration=400")
TABLE_2 = (0.0, 30.0, 58.0, 149.0, 175.0)
CRITERIA: tuple[Criterion, ...] = ("stress", "moment")
NOTE = (
    "IEA-15, fore-aft, 1 % noise, accelerometers at 0, 35, 40, 84, 175 m; settled covariance of "
    "the AKF, no record. Fewer inclinometers do not see all loads: the error grows without end."
)
MOST = 5
RECORDS = 3
RANDOM = 12


def tabulate(
    criterion: Criterion, how: str, choices: list[Choice], case: PlacementCase
) -> list[dict[str, object]]:
    """Return the rows of choices.csv."""
    return [
        {
            "criterion": criterion,
            "how": how,
            "inclinometers": len(choice.chosen),
            "heights": " ".join(f"{height:g}" for height in choice.heights),
            "stress": choice.stress,
            "weld": case.welds[choice.weld],
            "moment": choice.moment,
        }
        for choice in choices
    ]


def main(arguments: list[str]) -> int:
    folder = Path(arguments[0] if arguments else "results/tower_placement")
    try:
        config = compose(["study=tower", *SET_UP, *arguments[1:]])
        case = make_case(config, records=RECORDS)
    except InputError as error:
        print(f"placement: {error}", file=sys.stderr)
        return 2
    problem = case.problem
    folder.mkdir(parents=True, exist_ok=True)
    rows, sets = [], []
    for criterion in CRITERIA:
        greedy = choose_greedily(problem, MOST, criterion)
        best = [choose_exhaustively(problem, len(choice.chosen), criterion) for choice in greedy]
        rows += tabulate(criterion, "one by one", greedy, case)
        rows += tabulate(criterion, "all sets", best, case)
        sets += [choice.chosen for choice in (*greedy, *best)]
        with style.context():
            figure = draw_placement(problem, greedy, best, criterion, NOTE)
            print(*style.save(figure, folder, f"placement_{criterion}", None), sep="\n")
    pd.DataFrame(rows).to_csv(folder / "choices.csv", index=False)

    heights = list(problem.heights)
    draw = np.random.default_rng(config.seed)
    sets.append(tuple(heights.index(height) for height in TABLE_2))
    for count in np.resize([3, 4, 5], RANDOM):
        sets.append(tuple(sorted(int(n) for n in draw.choice(len(heights), count, replace=False))))
    checked = []
    for chosen in dict.fromkeys(sets):
        said = predict(problem, chosen)
        stress, moment = simulate(case, chosen, config.record.settled)
        checked.append({
            "heights": " ".join(f"{height:g}" for height in said.heights),
            "stress_predicted": said.stress, "stress_simulated": stress,
            "moment_predicted": said.moment, "moment_simulated": moment,
        })  # fmt: skip
    table = pd.DataFrame(checked)
    table.to_csv(folder / "checked.csv", index=False)
    print(pd.DataFrame(rows).to_string(index=False, float_format="%.4f"))
    print(table.to_string(index=False, float_format="%.4f"))
    for name in ("stress", "moment"):
        rank = spearmanr(table[f"{name}_predicted"], table[f"{name}_simulated"]).statistic
        print(f"rank correlation of predicted and simulated {name} errors: {rank:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
