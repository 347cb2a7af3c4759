"""A posterior of what Ren et al. (2019) leave open, given the 64 numbers of tables 6 to 9.

    python -m experiments.ren2019.posterior [FOLDER]
    python -m experiments.ren2019.posterior --check

FOLDER (default: results/reference/posterior) gets the tables and the figure. `--check` simulates
some draws of the stored posterior anew and compares.

`settings` names what is unknown, with priors; `components` simulates what each source of error
contributes; `emulator` interpolates that; `records` says how one record scatters; `likelihood`
joins them; `evidence` samples; `predict` and `held_out` predict what was not used; `identify` says
what the print fixes; `figure` draws.
"""

from __future__ import annotations

import sys
from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from joblib import Parallel, delayed

from experiments.ren2019.evidence import SCHEMES
from experiments.ren2019.posterior import held_out, identify
from experiments.ren2019.posterior.check import check
from experiments.ren2019.posterior.evidence import Posterior, load_posterior
from experiments.ren2019.posterior.figure import draw
from experiments.ren2019.posterior.inference import (
    PAPER,
    Inference,
    load_records,
    name_settings,
)
from experiments.ren2019.posterior.likelihood import Likelihood
from experiments.ren2019.posterior.predict import leave_tables_out, predict_numbers
from experiments.ren2019.posterior.settings import (
    ACCURACIES,
    FORCES,
    LENGTHS,
    NAMES,
    Reading,
    from_unit,
)
from owtsweep.io.steps import show_steps, tell_step
from owtsweep.io.tables import write_table

REFERENCE = Path("results/reference/posterior")
#: Where the simulated tables are kept; they can be made again.
KEPT = Path("results/posterior")
SEEDS = (1, 2)
#: Readings whose scatter is simulated with their own mode, and which are sampled again; and the
#: closest with a level IMU.
CLOSEST = 3
#: Draws of the posterior from which held-out statements are predicted, 8 records each.
DRAWS = 40
#: Settings on which winners hang, for the profiles.
PROFILED = ("r_gnss", "hme2_r_gnss", "mhe_q_a", "smoother_window", "bias_walk")


def list_readings() -> list[Reading]:
    """Return all combinations of accuracy, length and force; of a level IMU without start too."""
    whole = [Reading(a, n, True, f) for a, n, f in product(ACCURACIES, LENGTHS, FORCES)]
    return [*whole, *(Reading(a, n, start=False) for a, n in product(ACCURACIES, LENGTHS))]


def load_all(cases: list[tuple[Reading, dict[str, float]]]) -> None:
    """Simulate the records of readings and settings side by side, so that they are kept."""
    jobs = (delayed(load_records)(KEPT, reading, settings) for reading, settings in cases)
    Parallel(2, backend="multiprocessing")(jobs)


def sample_all(likelihoods: list[Likelihood], seed: int) -> list[Posterior]:
    """Sample side by side; posteriors are kept, so that a run that was stopped goes on."""
    return list(Parallel(2)(delayed(load_posterior)(KEPT, each, seed) for each in likelihoods))


def rank(found: list[Posterior]) -> list[int]:
    """Return the places of readings, the greatest evidence first."""
    order = np.argsort([-each.evidence for each in found], kind="stable")
    return [int(place) for place in order]


def choose_closest(likelihoods: list[Likelihood], found: list[Posterior]) -> list[int]:
    """Return the places of the closest readings, and of the closest with a level IMU, by seeds."""
    order = rank(found)
    level = {}
    for place in order:
        reading = likelihoods[place].reading
        if reading.force == "level":
            level.setdefault(reading.seeds, place)
    return list(dict.fromkeys([*order[:CLOSEST], *level.values()]))


def tabulate_evidence(
    likelihoods: list[Likelihood], found: list[Posterior], **others: list[Posterior]
) -> pd.DataFrame:
    """Return one row per reading, the greatest evidence first.

    log_evidence, error: with discrepancies; log_evidence_<name>: of `others`. best_log_likelihood.
    below: the logarithm of the evidence below the greatest.
    """
    rows = [
        {
            **vars(each.reading),
            "log_evidence": one.evidence,
            "error": one.error,
            **{f"log_evidence_{name}": other[place].evidence for name, other in others.items()},
            "best_log_likelihood": float(one.likelihoods.max()),
            "freedom": each.scatter.freedom,
        }
        for place, (each, one) in enumerate(zip(likelihoods, found, strict=True))
    ]
    table = pd.DataFrame(rows).sort_values("log_evidence", ascending=False, kind="stable")
    return table.assign(below=table["log_evidence"] - table["log_evidence"].max())


def main(folder: Path) -> None:
    """Run all, some three quarters of an hour on two cores, and write the tables."""
    folder.mkdir(parents=True, exist_ok=True)
    with show_steps():
        tell_step("components of each scheme's error")
        inference = Inference(KEPT)
        tell_step("scatter of single records")
        load_all([(Reading(accuracy), PAPER) for accuracy in ACCURACIES])
        tell_step("evidence of all readings")
        likelihoods = [inference.likelihood(each) for each in list_readings()]
        found = sample_all(likelihoods, SEEDS[0])
        shared = [
            replace(likelihoods[place].reading, seeds="shared")
            for place in choose_closest(likelihoods, found)
        ]
        likelihoods += [inference.likelihood(each) for each in shared]
        found += sample_all(likelihoods[-len(shared) :], SEEDS[0])
        write_table(folder, "readings", tabulate_evidence(likelihoods, found))

        tell_step("the closest readings, with the scatter of their own modes")
        modes = [
            (likelihoods[place].reading, name_settings(found[place].best))
            for place in choose_closest(likelihoods, found)
        ]
        load_all(modes)
        own = [inference.likelihood(reading, settings) for reading, settings in modes]
        found, again = (sample_all(own, seed) for seed in SEEDS)
        plain = sample_all([replace(each, discrepant=False) for each in own], SEEDS[0])
        narrow = sample_all([replace(each, part=0.5) for each in own], SEEDS[0])
        evidence = tabulate_evidence(own, found, again=again, plain=plain, narrow=narrow)
        write_table(folder, "evidence", evidence)

        place = rank(found)[0]
        likelihood, posterior = own[place], found[place]
        tell_step(f"the best reading: {likelihood.reading}")
        write_table(folder, "settings", identify.tabulate_widths(posterior))
        draws = posterior.points[:: len(posterior.points) // 200]
        stored = np.hstack([from_unit(draws[:, : len(NAMES)]), list(map(likelihood.scales, draws))])
        names = [*NAMES, *(f"discrepancy_{scheme}" for scheme in SCHEMES)]
        write_table(folder, "draws", pd.DataFrame(stored, columns=names))
        left_out = leave_tables_out(likelihood, sample_all)
        numbers = predict_numbers(likelihood, posterior, left_out)
        write_table(folder, "numbers", numbers)
        values, vectors = identify.find_directions(likelihood, draws[::4])
        directions = pd.DataFrame(vectors, columns=NAMES)
        directions.insert(0, "information", values)
        write_table(folder, "directions", directions)
        profiles = Parallel(2)(
            delayed(identify.find_profile)(likelihood, posterior, name) for name in PROFILED
        )
        write_table(folder, "profiles", pd.concat(profiles))

        tell_step("held-out statements")
        priors = np.random.default_rng(3).random((DRAWS, likelihood.dimensions))
        statements = pd.concat(
            [
                held_out.tabulate("posterior", likelihood.reading, posterior.points[:DRAWS]),
                held_out.tabulate("prior", likelihood.reading, priors),
                held_out.tabulate_settings("tuning=paper", Reading(), PAPER),
            ]
        )
        write_table(folder, "statements", statements)
        draw(folder)


if __name__ == "__main__":
    if "--check" in sys.argv:
        sys.exit(check(REFERENCE))
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else REFERENCE)
