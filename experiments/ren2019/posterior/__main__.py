"""A posterior of what Ren et al. (2019) leave open, given the 64 numbers of tables 6 to 9.

    python -m experiments.ren2019.posterior [FOLDER]
    python -m experiments.ren2019.posterior --check

FOLDER (default: results/reference/posterior) gets the tables and the figure. `--check` simulates
some draws of the stored posterior anew and compares.

`settings` names what is unknown, with priors; `components` simulates what each source of error
contributes; `emulator` interpolates that; `records` says how one record scatters; `likelihood`
joins them; `evidence` samples; `looks` follows readings; `predict` and `held_out` predict what was
not used; `identify` says what the print fixes; `figure` draws.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd
from joblib import Parallel, delayed

from experiments.ren2019.evidence import SCHEMES
from experiments.ren2019.posterior import held_out, identify
from experiments.ren2019.posterior.check import check
from experiments.ren2019.posterior.evidence import Posterior
from experiments.ren2019.posterior.figure import draw
from experiments.ren2019.posterior.inference import SEARCHED, Inference
from experiments.ren2019.posterior.looks import (
    CLOSELY,
    KEPT,
    SEEDS,
    Look,
    choose_closest,
    look_again,
    look_first,
    sample_all,
    take_own,
    take_turn,
)
from experiments.ren2019.posterior.predict import (
    leave_tables_out,
    predict_numbers,
    tabulate_left_out,
    tabulate_ratios,
)
from experiments.ren2019.posterior.records import RECORDS
from experiments.ren2019.posterior.settings import NAMES, Reading, from_unit
from owtsweep.io.tables import write_table
from owtsweep.io.terminal import show_steps, tell_step

REFERENCE = Path("results/reference/posterior")
#: Draws of the posterior from which held-out statements are predicted, 8 records each: of the
#: closest reading, and of each other one.
DRAWS, FEWER = 40, 8
#: Settings on which winners hang, for the profiles.
PROFILED = ("r_gnss", "hme2_r_gnss", "mhe_q_a", "smoother_window", "bias_walk")


def tabulate_evidence(looks: Sequence[Look], **others: list[Posterior]) -> pd.DataFrame:
    """Return one row per reading, the greatest evidence first.

    log_evidence, error: with discrepancies; log_evidence_<name>: of `others`. best_log_likelihood.
    freedom: of the scatter, which was computed anew `turns` times; `moved` is what the last turn
    added to the evidence. below: the logarithm of the evidence below the greatest.
    """
    rows = [
        {
            **vars(look.reading),
            "log_evidence": look.posterior.evidence,
            "error": look.posterior.error,
            **{f"log_evidence_{name}": other[place].evidence for name, other in others.items()},
            "best_log_likelihood": float(look.posterior.likelihoods.max()),
            "freedom": look.likelihood.scatter.freedom,
            "turns": look.turns,
            "moved": look.moved,
        }
        for place, look in enumerate(looks)
    ]
    table = pd.DataFrame(rows).sort_values("log_evidence", ascending=False, kind="stable")
    return table.assign(below=table["log_evidence"] - table["log_evidence"].max())


def main(folder: Path) -> None:
    """Run all, some two hours on two cores, and write the tables."""
    folder.mkdir(parents=True, exist_ok=True)
    with show_steps():
        tell_step("components of each scheme's error")
        inference = Inference(KEPT)
        tell_step("a first look at all readings, with the scatter of what was searched")
        first = look_first(inference)
        write_table(folder, "first_look", tabulate_evidence(first))
        tell_step("near readings, followed with the scatter of their own draws")
        near = look_again(inference, first)
        write_table(folder, "readings", tabulate_evidence(near))

        tell_step("the closest readings: more live points, other seeds and priors")
        chosen = choose_closest(near)
        looks = take_turn(inference, chosen, CLOSELY)
        own, found = [look.likelihood for look in looks], [look.posterior for look in looks]
        # other records too, so that the scatter's own noise shows
        again = sample_all(take_own(inference, chosen, first=RECORDS), SEEDS[1], CLOSELY)
        plain = sample_all([replace(each, discrepant=False) for each in own])
        narrow = sample_all([replace(each, part=0.5) for each in own])
        evidence = tabulate_evidence(looks, again=again, plain=plain, narrow=narrow)
        write_table(folder, "evidence", evidence)
        write_table(folder, "modes", tabulate_ratios(own, found))

        place = int(np.argmax([one.evidence for one in found]))
        likelihood, posterior = own[place], found[place]
        tell_step(f"the best reading: {likelihood.reading}")
        write_table(folder, "settings", identify.tabulate_widths(posterior))
        draws = posterior.points[:: len(posterior.points) // 200]
        stored = np.hstack([from_unit(draws[:, : len(NAMES)]), list(map(likelihood.scales, draws))])
        names = [*NAMES, *(f"discrepancy_{scheme}" for scheme in SCHEMES)]
        write_table(folder, "draws", pd.DataFrame(stored, columns=names))
        values, vectors = identify.find_directions(likelihood, draws[::4])
        directions = pd.DataFrame(vectors, columns=NAMES)
        directions.insert(0, "information", values)
        write_table(folder, "directions", directions)
        profiles = Parallel(2)(
            delayed(identify.find_profile)(likelihood, posterior, name) for name in PROFILED
        )
        write_table(folder, "profiles", pd.concat(profiles))

        tell_step("tables left out, for the closest readings")
        predicted = [
            predict_numbers(each, one, leave_tables_out(each, sample_all))
            for each, one in zip(own, found, strict=True)
        ]
        write_table(folder, "numbers", predicted[place])
        write_table(folder, "left_out", tabulate_left_out(own, predicted))

        tell_step("held-out statements")
        priors = np.random.default_rng(3).random((DRAWS, likelihood.dimensions))
        statements = pd.concat(
            [
                held_out.tabulate("posterior", likelihood.reading, posterior.points[:DRAWS]),
                held_out.tabulate("prior", likelihood.reading, priors),
                held_out.tabulate_settings("searched", Reading(), SEARCHED),
            ]
        )
        write_table(folder, "statements", statements)
        tell_step("held-out statements under each near reading")
        by_reading = pd.concat(
            held_out.tabulate(str(look.reading), look.reading, look.posterior.points[:FEWER])
            for look in near
            if look.reading.seeds == "own"  # which are in no statement
        )
        write_table(folder, "statements_by_reading", by_reading)
        draw(folder)


if __name__ == "__main__":
    if "--check" in sys.argv:
        sys.exit(check(REFERENCE))
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else REFERENCE)
