"""Shows a contest: maps of which scheme is best in which cell, as figures and on the terminal."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import pandas as pd

from owtsweep.results.answer import tell_alike, tell_answer, tell_beaten, tell_counts
from owtsweep.results.regret import tell_regret
from owtsweep.studies.base.contest import WINDOW, C, Contest, describe_draws
from owtsweep.studies.base.keys import ContestConfig
from owtsweep.studies.base.schemes import list_names
from owtsweep.studies.base.tables import find_latencies, list_competing
from owtsweep.studies.registry import list_schemes

if TYPE_CHECKING:
    from rich.console import RenderableType


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
