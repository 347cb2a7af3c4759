"""Find the conditions and schemes that all compared runs have, and each run's results there."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import pandas as pd

from owtsweep.comparing.comparison import Aspects, Candidate
from owtsweep.config import require
from owtsweep.errors import InputError
from owtsweep.results.best_scheme import find_best_schemes
from owtsweep.results.boundary import find_boundary, subtract_schemes
from owtsweep.results.conditions import Value, order_values, show_value
from owtsweep.results.cube import Cube


def find_common(runs: Sequence[Candidate], aspects: Sequence[Aspects]) -> tuple[Aspects, list[str]]:
    """Find the schemes, and the values of each condition, that all runs have.

    Raise `InputError` if the runs have no scheme or no value of some condition in common, have
    different conditions or criteria, or if some have records and others expected values only.

    Return the description of the first run with only those schemes and values; and sentences for
    the user on what was left out, and what runs without records lack.
    """
    first = aspects[0]
    without = " or ".join(
        sorted({r.config.engine for r, a in zip(runs, aspects, strict=True) if a.best_of})
    )
    require(
        len({a.best_of is None for a in aspects}) == 1,
        f"engine: some runs are of engine={without}, which has no records, and other runs have "
        f"records; compare only runs with records, or only runs of engine={without}",
    )
    criteria = list(dict.fromkeys(a.criterion for a in aspects))
    require(
        len(criteria) == 1,
        f"measures.criterion: the runs are judged by {' and '.join(criteria)}, which are different "
        "quantities; compare runs with one criterion",
    )
    require(
        all(a.conditions == first.conditions for a in aspects),
        "grid: the runs have different conditions; compare runs with equal conditions",
    )
    notes = []
    if without:
        notes.append(
            f"engine={without} has no records: n is 0, nothing has an interval, and no change is "
            "called established"
        )
    beside = list(dict.fromkeys(name for a in aspects for name in a.beside))
    if beside:
        notes.append(
            f"baselines ({', '.join(beside)}) take no part: best is the best of the schemes, also "
            "where a baseline has less error"
        )
    grid: dict[str, list[Value]] = {}
    for name in first.names:
        axes = [set(a.grid[name]) for a in aspects]
        shared = axes[0].intersection(*axes[1:])
        key = f"grid.{name}"
        require(bool(shared), f"{key}: the runs have no value in common; compare other runs")
        grid[name] = order_values(list(shared), first.grid[name])
        if any(axis != shared for axis in axes):
            kept = ", ".join(map(show_value, grid[name]))
            notes.append(f"{key} differs between the runs; compared is what all have: {kept}")
    schemes = [name for name in first.schemes if all(name in a.schemes for a in aspects)]
    require(bool(schemes), "schemes: the runs have no scheme in common; compare other runs")
    left_out = sorted({name for a in aspects for name in a.schemes} - set(schemes))
    if left_out:
        notes.append(f"schemes that not all runs have are left out: {', '.join(left_out)}")
    return replace(first, grid=grid, schemes=schemes), notes


@dataclass(frozen=True)
class Judged:
    """A run's results in the cells and schemes that all compared runs have.

    best: the best scheme of every cell; columns as in best_scheme.csv.
    samples: the MSE by which schemes are judged: one row per scheme and cell, one column per
        replicate, NaN where a scheme did not finish a replicate.
    boundaries, products: as `results.boundary.find_boundary` returns them, and the data they are
        computed from, as `subtract_schemes` there returns them. None if the study names no two
        schemes for a boundary, or the boundaries cannot be computed.
    no_boundary: a sentence that says why the boundaries cannot be computed; otherwise "".
    """

    run: Candidate
    aspects: Aspects
    best: pd.DataFrame
    samples: pd.DataFrame
    boundaries: pd.DataFrame | None = None
    products: pd.DataFrame | None = None
    no_boundary: str = ""


def judge(run: Candidate, aspects: Aspects, shared: Aspects) -> Judged:
    """Compute a run's results in the cells and schemes of `shared`, from `find_common`."""
    rows, criterion = run.rows, shared.criterion
    for condition in shared.conditions:
        if not condition.expands:
            rows = rows[rows[condition.name].isin(shared.grid[condition.name])]
    cube = Cube.of_rows(rows, shared.schemes, shared.conditions, shared.grid)
    if aspects.best_of is None:
        best = find_best_schemes(cube, aspects.window, [criterion])
    else:
        best = aspects.best_of(rows, shared.grid, shared.schemes, criterion)
    samples = _arrange_samples(cube, aspects.window, shared)
    if shared.boundary is None:
        return Judged(run, aspects, best, samples)
    query = shared.conditions, shared.boundary, criterion, aspects.window
    try:
        products = subtract_schemes(rows, *query)
    except InputError as error:  # a scheme is missing, or amplitudes were run one by one
        reason = f"{run.label}: no {'/'.join(shared.boundary)} boundary ({error})"
        return Judged(run, aspects, best, samples, no_boundary=reason)
    return Judged(run, aspects, best, samples, find_boundary(products, shared.boundary), products)


def _arrange_samples(cube: Cube, window: str, shared: Aspects) -> pd.DataFrame:
    labels = shared.schemes, *(shared.grid[name] for name in shared.names)
    cells = pd.MultiIndex.from_product(labels, names=["scheme", *shared.names])
    return cube.widen(shared.criterion, window).reindex(index=cells).astype(float)
