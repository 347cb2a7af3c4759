"""Compare runs of one study: make the tables, the figures and the text of the report."""

from __future__ import annotations

import textwrap
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from owtsweep.comparing import report
from owtsweep.comparing.common import Judged, find_common, judge
from owtsweep.comparing.comparison import Aspects, Candidate, Comparison, Findings, Pair
from owtsweep.errors import InputError, require

if TYPE_CHECKING:
    from matplotlib.figure import Figure

__all__ = ["compare"]


def compare(
    comparison: Comparison,
    folder: Path,
    describe: Callable[[Candidate], Aspects],
    *,
    metadata: Mapping[str, str],
) -> Findings:
    """Make tables, figures and text on how best scheme, boundary and errors change between runs.

    The figures are written into `folder`, with the texts of `metadata` inside; tables and text are
    only returned. `describe` returns the study's description of a run. Raise `InputError` if the
    runs cannot be compared, for example because they have no scheme in common, or no run has a
    usable number: a stranger may seal NaN, or the name of another scheme.
    """
    aspects = [describe(run) for run in comparison.runs]
    shared, left_out = find_common(comparison.runs, aspects)
    runs = [judge(run, own, shared) for run, own in zip(comparison.runs, aspects, strict=True)]
    require(
        any(run.samples.shape[1] > 0 for run in runs),
        f"runs: none has a finite number of {', '.join(shared.schemes)} in a cell; sweep them "
        "again with --fresh",
    )
    tables = {
        "runs": pd.DataFrame(
            [{"folder": run.name, "hash": run.hash, **run.written} for run in comparison.runs]
        ),
        "best_schemes": _gather(comparison.runs, [run.best for run in runs]),
        "boundaries": _gather(comparison.runs, [run.boundaries for run in runs]),
    }
    pair_tables, unpaired = _compare_pairs(comparison.pairs, runs, shared)
    tables |= pair_tables
    if shared.boundary is None:
        tables = {name: table for name, table in tables.items() if not name.startswith("boundar")}
    origin = report.describe_origins(aspects)
    figures, undrawn = _draw(comparison, shared, runs, folder, metadata, origin)
    overview = report.make_overview(runs, shared, tables["changed_cells"])
    text = report.write_sections(shared, tables)
    no_boundary = [run.no_boundary for run in runs if run.no_boundary]
    notes = (*left_out, *no_boundary, *unpaired, *undrawn)
    return Findings(tables, overview, notes, text, tuple(figures), origin)


def _gather(runs: Sequence[Candidate], tables: Sequence[pd.DataFrame | None]) -> pd.DataFrame:
    """Join the tables of the runs that have one; the first columns are folder and swept values."""
    return pd.DataFrame(
        {"folder": run.name} | run.written | row
        for run, table in zip(runs, tables, strict=True)
        if table is not None
        for row in table.to_dict("records")
    )


def _compare_pairs(
    pairs: Sequence[Pair], runs: Sequence[Judged], shared: Aspects
) -> tuple[dict[str, pd.DataFrame], list[str]]:
    """Return the tables of pairs of runs, and a note if some differ in motion and noise."""

    from owtsweep.comparing import changes

    names, before = shared.names, changes.PAIR_COLUMNS
    columns = {
        "boundary_shifts": [*before, *names[:-1], *changes.SHIFT_COLUMNS],
        "changed_cells": [*before, *names, *changes.CHANGED_COLUMNS],
        "scheme_changes": [*before, "scheme", *names, *changes.SCHEME_COLUMNS],
    }
    lines: dict[str, list[changes.Row]] = {name: [] for name in columns}
    winners = [changes.list_winners(run.best, names) for run in runs]
    # expected values are stored as replicate 0, but they are not samples
    counts = {} if shared.best_of is None else {"n_from": 0, "n_to": 0}
    unpaired: dict[str, None] = {}
    for pair in pairs:
        a, b = pair.first, pair.second
        one, other = runs[a], runs[b]
        keys = one.aspects.pairing
        differing = [key for key in keys if keys[key] != other.aspects.pairing[key]]
        unpaired |= dict.fromkeys(differing)
        paired = not differing
        ends = (one.run.label, other.run.label, pair.along, paired)
        head = dict(zip(changes.PAIR_COLUMNS, ends, strict=True))
        judged_by = head | {"criterion": shared.criterion}
        samples = one.samples.align(other.samples, axis=1)
        cells = changes.compare_cells(*samples, winners[a], winners[b], paired=paired)
        schemes = changes.compare_schemes(*samples, paired=paired)
        lines["changed_cells"] += [judged_by | row | counts for row in cells]
        lines["scheme_changes"] += [judged_by | row | counts for row in schemes]
        if one.products is not None and other.products is not None:
            shifts = changes.compare_boundaries(one.products, other.products, paired=paired)
            lines["boundary_shifts"] += [head | row for row in shifts]
    notes = []
    if unpaired:
        notes.append(
            f"{', '.join(unpaired)} differs between runs: those pairs are not paired, their "
            "intervals are unpaired (Welch)"
        )
    return {name: pd.DataFrame(lines[name], columns=columns[name]) for name in columns}, notes


def _draw(
    comparison: Comparison,
    shared: Aspects,
    runs: Sequence[Judged],
    folder: Path,
    metadata: Mapping[str, str],
    origin: str,
) -> tuple[list[Path], list[str]]:
    """Save the figures, with `origin` above each; return the files, and why others are missing."""

    from owtsweep.comparing import boundary_figure, maps
    from owtsweep.figures import style
    from owtsweep.figures.plane import Plane

    panels = maps.arrange(comparison)
    if panels is None:
        return [], [
            f"{len(runs)} runs that differ in {', '.join(comparison.keys)}: tables "
            f"only; figures show one or two keys and at most {maps.MOST_PANELS} panels"
        ]
    windows = dict.fromkeys(run.aspects.window for run in runs)
    described = " or ".join(style.describe_window(window) for window in windows)
    subtitle = f"by {shared.criterion} {shared.score}, {described}"
    files, notes = [], []
    try:
        plane = Plane.over(shared.conditions, shared.grid)
    except InputError as error:
        notes.append(f"no maps ({error})")
    else:
        figure = maps.draw(panels, runs, shared, plane, subtitle=subtitle)
        _add_origin(figure, origin)
        files += style.save(figure, folder, "best_scheme_maps", metadata)
    if shared.boundary is None:
        return files, notes
    parts = [
        run.boundaries.assign(index=index)
        for index, run in enumerate(runs)
        if run.boundaries is not None
    ]
    if not any((part["wins"] == "").any() for part in parts):
        notes.append(f"no run has an {'/'.join(shared.boundary)} boundary: see boundaries.csv")
        return files, notes
    boundaries = pd.concat(parts, ignore_index=True)
    figure = boundary_figure.draw(boundaries, comparison, shared, subtitle=subtitle)
    _add_origin(figure, origin)
    return files + style.save(figure, folder, "boundary", metadata), notes


def _add_origin(figure: Figure, origin: str) -> None:
    from owtsweep.figures import style

    if origin:
        letters = int(12.5 * figure.get_figwidth())  # of the size of the legend's title
        style.add_origin(figure, "\n".join(textwrap.wrap(origin, letters)))
