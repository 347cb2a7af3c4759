"""Shows a contest: maps of which scheme is best in which cell, as figures and on the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import partial
from typing import TYPE_CHECKING

import pandas as pd

from owtsweep.figures.drawings import Drawing, save_figure
from owtsweep.results.answer import tell_alike, tell_answer, tell_beaten, tell_counts
from owtsweep.results.best_scheme import find_coinciding
from owtsweep.results.regret import tell_regret
from owtsweep.results.status import FAILED
from owtsweep.studies.base.contest import WINDOW, C, Contest, ContestConfig, describe_draws
from owtsweep.studies.base.schemes import list_names
from owtsweep.studies.base.tables import find_latencies, list_competing, make_cube
from owtsweep.studies.registry import list_schemes

#: Letters of the lines above a map that fit into an inch.
LETTERS_PER_INCH = 9.5

if TYPE_CHECKING:
    from rich.console import RenderableType


def list_maps(
    contest: Contest[C],
    config: C,
    tables: Mapping[str, pd.DataFrame],
    rows: pd.DataFrame,
    metadata: Mapping[str, str],
    contenders: Sequence[str] = (),
) -> dict[str, Drawing]:
    """Return name -> function that draws: "map_<criterion>" of each criterion, "distributions".

    The latter shows single records, if there are several, by the key `criterion`. `contenders`
    names the schemes, the simplest first, if cells get records until they are decided.
    """
    from owtsweep.figures import best_scheme_map, distributions, regret_map

    origin = (
        f"Truth: {contest.describe_truth(config)}; {describe_draws(config)}.\n"
        f"Sensors: {contest.describe_sensors(config)}."
    )
    save = partial(save_figure, metadata=metadata, origin=origin, letters=LETTERS_PER_INCH)
    cube = make_cube(contest, config, rows, list_competing(config, rows))
    conditions, records = contest.find_conditions(config), config.grid.describe_records()
    notes = [*tell_unable(cube.unable), *tell_latencies(config, rows)]
    failures = int(((rows["status"] == FAILED) & rows["scheme"].isin(list(cube.schemes))).sum())
    drawings = {
        f"map_{name}": save(
            partial(
                best_scheme_map.draw, tables["best_scheme"], cube.schemes, conditions,
                criterion=name, window=WINDOW, tuning=config.tuning_name, quantity=criterion.title,
                coinciding=find_coinciding(cube, [name], contenders), records=records,
                failures=failures, notes=notes,
            )
        )
        for name, criterion in contest.criteria.items()
        if name in set(tables["best_scheme"]["criterion"])
    }  # fmt: skip
    of_regret = regret_map.list_maps(tables, cube.schemes, conditions, config.tuning_name, records)
    drawings |= {name: save(draw) for name, draw in of_regret.items()}
    if config.grid.first >= distributions.LEAST_RECORDS:
        title = f"Errors of single records by {contest.criteria[config.criterion].title}"
        drawings[distributions.NAME] = save(
            partial(
                distributions.draw, cube, config.criterion, WINDOW,
                title=title, tuning=config.tuning_name, label="error",
            )
        )  # fmt: skip
    return drawings


def show(contest: Contest[C], config: C, tables: Mapping[str, pd.DataFrame]) -> RenderableType:
    """Return the map by the key `criterion`, and who wins by each one."""
    from owtsweep.figures.terminal import frame, grid

    chosen = contest.criteria[config.criterion]
    schemes = list_competing(config, tables["summary"])
    shown = grid(
        tables["best_scheme"], schemes, contest.find_conditions(config), config.criterion, WINDOW,
        quantity=chosen.title, unit=chosen.unit,
    )  # fmt: skip
    return frame(list_origin_lines(contest, config), shown, tell(contest, config, tables))


def list_origin_lines(contest: Contest[C], config: C) -> list[str]:
    """Return lines on the tuning, the truth, the sensors, the records and their seed."""
    return [
        f"Tuning {config.tuning_name}, {contest.describe_truth(config)}",
        f"Sensors: {contest.describe_sensors(config)}; {describe_draws(config)}",
    ]


def tell(contest: Contest[C], config: C, tables: Mapping[str, pd.DataFrame]) -> list[str]:
    """Return sentences: who is best by the key `criterion`, who wins by each other one."""
    best, ratios = tables["best_scheme"], tables["ratios"]
    schemes = list_competing(config, tables["summary"])
    waiting = [name for name in list_names(config.schemes) if name not in schemes]
    conditions, chosen = contest.find_conditions(config), contest.criteria[config.criterion]
    lines: list[str] = []
    for name in [config.criterion, *contest.criteria]:
        cells = best[best["criterion"] == name]
        if not len(cells):
            continue
        if name == config.criterion and not lines:
            lines += tell_answer(cells, ratios, chosen, conditions)
            own = [scheme for scheme in schemes if scheme not in list_schemes(config.study)]
            lines += tell_beaten(own, cells, ratios, chosen)
            lines += tell_alike(own, tables["summary"], [*contest.criteria])
        elif name != config.criterion:
            lines.append(f"By {name.replace('_', ' ')}: {tell_counts(cells)}")
    if waiting:
        lines.append(f"Not in the contest, because its estimates wait: {', '.join(waiting)}.")
    return lines + tell_regret(tables) + contest.tell_more(config, tables)


def tell_unable(unable: pd.DataFrame) -> list[str]:
    """Return a sentence on schemes that could not work; `unable` is that of a `Cube`."""
    if unable.empty:
        return []
    counts = unable["scheme"].astype(str).value_counts(sort=False)
    text = ", ".join(f"{name} in {n} cell{'s' * (n != 1)}" for name, n in counts.items())
    return [f"Unable to work, with its reason in summary.csv: {text}."]


def tell_latencies(config: ContestConfig, rows: pd.DataFrame) -> list[str]:
    """Return a sentence on schemes with a latency, if others have none."""
    latencies = find_latencies(rows)
    if not latencies or list_competing(config, rows) == list_names(config.schemes):
        return []
    text = " and ".join(f"{name} ({wait:.3g} s)" for name, wait in latencies.items())
    return [f"In summary.csv, but not in the contest, because estimates wait: {text}."]
