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
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.stats import spearmanr

from experiments.command import write
from experiments.tower.placement_figure import draw_placement
from owtsweep.errors import InputError
from owtsweep.streams import stream
from owtsweep.studies.registry import compose
from owtsweep.studies.tower.measuring import Faults, Place, add_errors, take_signals
from owtsweep.studies.tower.placement import (
    Choice,
    Criterion,
    PlacementCase,
    choose_exhaustively,
    choose_greedily,
    pose,
    predict,
)
from owtsweep.studies.tower.placement_case import make_case
from owtsweep.studies.tower.schemes import SCHEMES
from owtsweep.studies.tower.truth import Motion, make_truth

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
            "criterion": criterion, "how": how, "inclinometers": len(choice.chosen),
            "heights": " ".join(f"{height:g}" for height in choice.heights),
            "stress": choice.stress, "weld": case.welds[choice.weld], "moment": choice.moment,
        }
        for choice in choices
    ]  # fmt: skip


def simulate(
    case: PlacementCase, motions: Sequence[Motion], chosen: Sequence[int], first: int
) -> tuple[float, float]:
    """Run the AKF on records of true motions with some of the candidates; return its real errors.

    `first` is the number of the first sample that is judged. The errors are root mean squares of
    the stress at the worst weld and of M0, each over its scale and averaged over the records.

    Raises
    ------
    Unable
        If the sensors see too little.
    """
    channels = (*case.setting.channels, *(case.candidates[number] for number in chosen))
    setting = replace(case.setting, channels=channels)
    prepared = SCHEMES.resolve("AKF_STEADY").prepare(setting)
    sigma = np.array([channel.sigma for channel in channels])
    places = [Place(channel.kind, channel.node) for channel in channels]
    names = [f"{kind}_{node}" for kind, node, _ in places]
    faults = Faults()
    errors = []
    for number, motion in enumerate(motions):
        signals = take_signals(motion, setting.strain, places, faults)
        draw = partial(stream, 0, "tower", [], number)
        guess = prepared.run(add_errors(signals, sigma, faults, draw, names, setting.step))
        wrong = (guess.displacement - motion.displacement)[first:] @ case.stress.T
        stress = np.sqrt(np.mean(wrong**2, axis=0)) / case.stress_scale
        moment = np.sqrt(np.mean((guess.inputs - motion.inputs)[first:, 1] ** 2))
        errors.append((stress.max(), moment / case.moment_scale))
    stress_error, moment_error = np.mean(errors, axis=0)
    return float(stress_error), float(moment_error)


def main(arguments: list[str]) -> int:
    folder = Path(arguments[0] if arguments else "results/tower_placement")
    try:
        config = compose(["study=tower", *SET_UP, *arguments[1:]])
        case = make_case(config)
        motions = [make_truth(config, number)["fa"] for number in range(RECORDS)]
    except InputError as error:
        print(f"placement: {error}", file=sys.stderr)
        return 2
    problem = pose(case)
    rows, sets, figures = [], [], {}
    for criterion in CRITERIA:
        greedy = choose_greedily(problem, MOST, criterion)
        best = [choose_exhaustively(problem, len(choice.chosen), criterion) for choice in greedy]
        rows += tabulate(criterion, "one by one", greedy, case)
        rows += tabulate(criterion, "all sets", best, case)
        sets += [choice.chosen for choice in (*greedy, *best)]
        figures[f"placement_{criterion}"] = partial(
            draw_placement, problem, greedy, best, criterion, NOTE
        )

    heights = list(problem.heights)
    draw = np.random.default_rng(config.seed)
    sets.append(tuple(heights.index(height) for height in TABLE_2))
    for count in np.resize([3, 4, 5], RANDOM):
        sets.append(tuple(sorted(int(n) for n in draw.choice(len(heights), count, replace=False))))
    checked = []
    for chosen in dict.fromkeys(sets):
        said = predict(problem, chosen)
        stress, moment = simulate(case, motions, chosen, config.record.settled)
        checked.append({
            "heights": " ".join(f"{height:g}" for height in said.heights),
            "stress_predicted": said.stress, "stress_simulated": stress,
            "moment_predicted": said.moment, "moment_simulated": moment,
        })  # fmt: skip
    tables = {"choices": pd.DataFrame(rows), "checked": pd.DataFrame(checked)}
    write(folder, tables, figures)
    for table in tables.values():
        print(table.to_string(index=False, float_format="%.4f"))
    for name in ("stress", "moment"):
        values = (tables["checked"][f"{name}_{how}"] for how in ("predicted", "simulated"))
        rank = spearmanr(*values).statistic
        print(f"rank correlation of predicted and simulated {name} errors: {rank:.2f}")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
