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
from collections.abc import Mapping
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
    first_of,
    load_records,
    name_settings,
)
from experiments.ren2019.posterior.likelihood import Likelihood
from experiments.ren2019.posterior.predict import (
    leave_tables_out,
    predict_numbers,
    tabulate_left_out,
)
from experiments.ren2019.posterior.settings import (
    ACCURACIES,
    FORCES,
    LENGTHS,
    MOTIONS,
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
#: Live points of a first look, of each reading, and of the closest.
FIRST, LIVE, CLOSELY = 50, 80, 250
#: Readings whose evidence is this far below at the first look are not looked at again; and those
#: that are this far below then are not tried with shared seeds.
NEAR, CLOSE = 25.0, 12.0
#: How many of the closest readings are sampled closely.
CLOSEST = 4
#: Draws of the posterior from which held-out statements are predicted, 8 records each: of the
#: closest reading, and of each other one.
DRAWS, FEWER = 40, 8
#: Settings on which winners hang, for the profiles.
PROFILED = ("r_gnss", "hme2_r_gnss", "mhe_q_a", "smoother_window", "bias_walk")


def list_readings() -> list[Reading]:
    """Return combinations of accuracy, length and force, and of what is tried for some alone.

    A level IMU without its start at all lengths; other spectra at 400 s.
    """
    whole = [Reading(a, n, True, f) for a, n, f in product(ACCURACIES, LENGTHS, FORCES)]
    settled = [Reading(a, n, start=False) for a, n in product(ACCURACIES, LENGTHS)]
    moved = [
        Reading(accuracy, 400.0, True, force, spectrum)
        for accuracy in ACCURACIES
        for force, spectrum in MOTIONS
        if spectrum != "middle"
    ]
    return [*whole, *settled, *moved]


def load_all(cases: list[tuple[Reading, Mapping[str, float]]]) -> None:
    """Simulate the records of readings and settings side by side, so that they are kept."""
    different = {str((replace(of, seeds="own"), chosen)): (of, chosen) for of, chosen in cases}
    jobs = (delayed(load_records)(KEPT, of, chosen) for of, chosen in different.values())
    Parallel(2, backend="multiprocessing")(jobs)


def sample_all(
    likelihoods: list[Likelihood], seed: int = SEEDS[0], live: int = LIVE
) -> list[Posterior]:
    """Sample side by side; posteriors are kept, so that a run that was stopped goes on."""
    jobs = (delayed(load_posterior)(KEPT, each, seed, live) for each in likelihoods)
    return list(Parallel(2)(jobs))


def take_own(inference: Inference, found: list[tuple[Reading, Posterior]]) -> list[Likelihood]:
    """Return the likelihoods of readings with the scatter of their own modes."""
    modes = [(reading, name_settings(posterior.best)) for reading, posterior in found]
    load_all([*modes])
    return [inference.likelihood(reading, settings) for reading, settings in modes]


def rank(found: list[Posterior]) -> list[int]:
    """Return the places of readings, the greatest evidence first."""
    order = np.argsort([-each.evidence for each in found], kind="stable")
    return [int(place) for place in order]


def choose_closest(likelihoods: list[Likelihood], found: list[Posterior]) -> list[int]:
    """Return the places of the closest readings, and of the closest with a level IMU, by seeds."""
    order = rank(found)
    level: dict[str, int] = {}
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


def look_first(inference: Inference) -> tuple[list[Likelihood], list[Posterior]]:
    """Return likelihoods and posteriors of all readings, with the scatter of `tuning=paper`."""
    readings = list_readings()
    load_all([first_of(reading) for reading in readings])
    likelihoods = [inference.likelihood(reading) for reading in readings]
    return likelihoods, sample_all(likelihoods, live=FIRST)


def look_again(
    inference: Inference, likelihoods: list[Likelihood], found: list[Posterior]
) -> tuple[list[Likelihood], list[Posterior]]:
    """Return the same of near readings with scatter of their own; of close ones with both seeds."""
    own = take_own(inference, choose_near(likelihoods, found, NEAR))
    sampled = sample_all(own)
    close = choose_near(own, sampled, CLOSE)
    shared = take_own(inference, [(replace(each, seeds="shared"), one) for each, one in close])
    return [*own, *shared], [*sampled, *sample_all(shared)]


def choose_near(
    likelihoods: list[Likelihood], found: list[Posterior], near: float
) -> list[tuple[Reading, Posterior]]:
    """Return the readings whose evidence is less than `near` below the greatest."""
    least = max(one.evidence for one in found) - near
    pairs = zip(likelihoods, found, strict=True)
    return [(each.reading, one) for each, one in pairs if one.evidence > least]


def main(folder: Path) -> None:
    """Run all, some hour and a half on two cores, and write the tables."""
    folder.mkdir(parents=True, exist_ok=True)
    with show_steps():
        tell_step("components of each scheme's error")
        inference = Inference(KEPT)
        tell_step("a first look at all readings, with the scatter of tuning=paper")
        likelihoods, found = look_first(inference)
        write_table(folder, "first_look", tabulate_evidence(likelihoods, found))
        tell_step("near readings, with the scatter of their own modes")
        likelihoods, near = look_again(inference, likelihoods, found)
        write_table(folder, "readings", tabulate_evidence(likelihoods, near))

        tell_step("the closest readings: more live points, other seeds and priors")
        chosen = choose_closest(likelihoods, near)
        own = take_own(inference, [(likelihoods[p].reading, near[p]) for p in chosen])
        found, again = (sample_all(own, seed, CLOSELY) for seed in SEEDS)
        plain = sample_all([replace(each, discrepant=False) for each in own])
        narrow = sample_all([replace(each, part=0.5) for each in own])
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
                held_out.tabulate_settings("tuning=paper", Reading(), PAPER),
            ]
        )
        write_table(folder, "statements", statements)
        tell_step("held-out statements under each near reading")
        by_reading = pd.concat(
            held_out.tabulate(str(each.reading), each.reading, one.points[:FEWER])
            for each, one in zip(likelihoods, near, strict=True)
            if each.reading.seeds == "own"  # which are in no statement
        )
        write_table(folder, "statements_by_reading", by_reading)
        draw(folder)


if __name__ == "__main__":
    if "--check" in sys.argv:
        sys.exit(check(REFERENCE))
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else REFERENCE)
