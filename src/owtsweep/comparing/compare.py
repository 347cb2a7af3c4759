"""Compares runs of one study: tables, figures and text."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.comparing.aspects import Aspects
from owtsweep.comparing.common import (
    Common,
    arrange_samples,
    find_best,
    find_common,
    find_unpaired,
)
from owtsweep.comparing.comparison import Candidate, Comparison, Findings, Pair
from owtsweep.comparing.values import show
from owtsweep.errors import InputError

if TYPE_CHECKING:
    import pandas as pd


def compare(
    comparison: Comparison,
    folder: Path,
    describe: Callable[[Candidate], Aspects],
    *,
    metadata: Mapping[str, str],
) -> Findings:
    """Make tables, figures and text on how best scheme, boundary and errors change between runs.

    Parameters
    ----------
    comparison
        The runs, and the pairs of them to compare.
    folder
        Folder for the figures.
    describe
        Function that returns the study's description of a run.
    metadata
        Stored inside the figures.

    Raises
    ------
    InputError
        If the runs share no cell or scheme, or are judged by different criteria.
    """
    import pandas as pd

    from owtsweep.comparing import report

    shared = find_common(comparison.runs, [describe(run) for run in comparison.runs])
    best = [find_best(shared, index) for index in range(len(shared.runs))]
    boundaries, no_boundary = _find_boundaries(shared)
    pair_tables, unpaired = _compare_pairs(comparison.pairs, shared, best)
    runs = pd.DataFrame([_identify(run) for run in shared.runs])
    heads = runs.drop(columns="hash").to_dict("records")
    winners = [
        heads[index] | row for index, table in enumerate(best) for row in table.to_dict("records")
    ]
    lines = boundaries.drop(columns="index").to_dict("records")
    tables = {
        "runs": runs,
        "best_schemes": pd.DataFrame(winners),
        "boundaries": pd.DataFrame(
            [heads[index] | line for index, line in zip(boundaries["index"], lines, strict=True)]
        ),
        **pair_tables,
    }
    if shared.boundary is None:
        tables = {name: table for name, table in tables.items() if not name.startswith("boundar")}
    figures, undrawn = _draw(comparison, shared, best, boundaries, folder, metadata)
    overview = report.make_overview(shared, best, boundaries, tables["changed_cells"])
    text = report.write_sections(shared, tables)
    notes = (*shared.notes, *no_boundary, *unpaired, *undrawn)
    return Findings(tables, overview, notes, text, tuple(figures))


def _identify(run: Candidate) -> dict[str, str]:
    swept = {key: show(value) for key, value in run.values.items()}
    return {"folder": run.name, "hash": run.hash, **swept}


def _find_boundaries(shared: Common) -> tuple[pd.DataFrame, list[str]]:
    """The boundary of every run, with the run's `index`, and notes on why some have none."""
    import pandas as pd

    from owtsweep.results.boundary import COLUMNS, find_boundary

    empty = pd.DataFrame(columns=[*shared.names[:-1], *COLUMNS, "index"])
    if shared.boundary is None:
        return empty, []
    parts, notes = [], []
    for index, (run, aspects) in enumerate(zip(shared.runs, shared.aspects, strict=True)):
        rows = shared.choose_rows(index)
        try:
            table = find_boundary(
                rows, shared.conditions, shared.boundary, shared.criterion, aspects.window
            )
        except InputError as error:  # a scheme is missing, or amplitudes were run one by one
            notes.append(f"{run.label}: no {'/'.join(shared.boundary)} boundary ({error})")
            continue
        parts.append(table.assign(index=index))
    return (pd.concat(parts, ignore_index=True) if parts else empty), notes


def _compare_pairs(
    pairs: Sequence[Pair], shared: Common, best: Sequence[pd.DataFrame]
) -> tuple[dict[str, pd.DataFrame], list[str]]:
    """The tables of pairs of runs, and a note on pairs that do not share their records."""
    import pandas as pd

    from owtsweep.comparing import changes, shift

    names, criterion = shared.names, {"criterion": shared.criterion}
    samples = arrange_samples(shared)
    winners = [changes.list_winners(table, names) for table in best]
    # expected values are stored as replicate 0, but they are not samples
    counts = {} if shared.samples else {"n_from": 0, "n_to": 0}
    changed: list[dict[str, Any]] = []
    schemes: list[dict[str, Any]] = []
    shifts: list[dict[str, Any]] = []
    unpaired: dict[str, None] = {}
    for pair in pairs:
        a, b = pair.first, pair.second
        differing = find_unpaired(shared.aspects[a], shared.aspects[b])
        unpaired |= dict.fromkeys(differing)
        paired = not differing
        ends = (shared.runs[a].label, shared.runs[b].label, pair.along, paired)
        head = dict(zip(changes.PAIR_COLUMNS, ends, strict=True))
        cells = changes.compare_cells(samples[a], samples[b], winners[a], winners[b], paired=paired)
        moved = changes.compare_schemes(samples[a], samples[b], paired=paired)
        changed += [head | criterion | row | counts for row in cells]
        schemes += [head | criterion | row | counts for row in moved]
        if shared.boundary is None:
            continue
        try:
            lines = shift.compare_boundaries(
                (shared.choose_rows(a), shared.choose_rows(b)),
                shared.conditions,
                shared.boundary,
                shared.criterion,
                (shared.aspects[a].window, shared.aspects[b].window),
                paired=paired,
            )
        except InputError:  # the notes on boundaries give the reason
            continue
        shifts += [head | line for line in lines]
    notes = []
    if unpaired:
        notes.append(
            f"{', '.join(unpaired)} differs between runs: those pairs are not paired, their "
            "intervals are unpaired (Welch)"
        )
    before = changes.PAIR_COLUMNS
    tables = {
        "boundary_shifts": pd.DataFrame(shifts, columns=[*before, *names[:-1], *shift.COLUMNS]),
        "changed_cells": pd.DataFrame(changed, columns=[*before, *names, *changes.CHANGED_COLUMNS]),
        "scheme_changes": pd.DataFrame(
            schemes, columns=[*before, "scheme", *names, *changes.SCHEME_COLUMNS]
        ),
    }
    return tables, notes


def _draw(
    comparison: Comparison,
    shared: Common,
    best: Sequence[pd.DataFrame],
    boundaries: pd.DataFrame,
    folder: Path,
    metadata: Mapping[str, str],
) -> tuple[list[Path], list[str]]:
    """Draw the figures; return the files, and notes on figures that were not drawn."""
    from owtsweep.comparing import boundary_figure, maps
    from owtsweep.comparing.panels import MOST_PANELS, arrange
    from owtsweep.figures import style
    from owtsweep.figures.plane import Plane

    panels = arrange(comparison)
    if panels is None:
        return [], [
            f"{len(comparison.runs)} runs that differ in {', '.join(comparison.keys)}: tables "
            f"only; figures show one or two keys and at most {MOST_PANELS} panels"
        ]
    windows = dict.fromkeys(aspects.window for aspects in shared.aspects)
    described = " or ".join(style.describe_window(window) for window in windows)
    subtitle = f"by {shared.criterion} MSE, {described}"
    files, notes = [], []
    try:
        plane = Plane.over(shared.conditions, shared.grid)
    except InputError as error:
        notes.append(f"no maps ({error})")
    else:
        figure = maps.draw(panels, best, boundaries, shared, plane, subtitle=subtitle)
        files += style.save(figure, folder, "best_scheme_maps", metadata)
    if shared.boundary is None:
        return files, notes
    if not (boundaries["wins"] == "").any():
        notes.append(f"no run has an {'/'.join(shared.boundary)} boundary: see boundaries.csv")
        return files, notes
    figure = boundary_figure.draw(boundaries, comparison, shared, subtitle=subtitle)
    return files + style.save(figure, folder, "boundary", metadata), notes
