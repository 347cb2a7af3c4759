"""Gathers what the page of a run shows: results, claims, where they come from, and details.

Details are computed on request: 40 s of a record in each cell, and error spectra. A sweep stores
errors alone. So record 0 of each cell is made again, and what the schemes say of one quantity is
kept from the middle of the judged part on, because a scheme that learns the sea starts like another
one. Where one run serves all amplitudes, the least and the largest one are run: the page computes
the others, because these schemes are linear.
"""

from __future__ import annotations

import base64
import json
import shlex
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from io import StringIO
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import quote

import numpy as np
import pandas as pd
from pydantic import FiniteFloat

from owtsweep.arrays import Array
from owtsweep.config import AnyConfig, Config, changed
from owtsweep.errors import InputError, printable
from owtsweep.io.reading import read_as
from owtsweep.io.tables import read_table
from owtsweep.io.terminal import tell_step
from owtsweep.report.run_page import Extras, Origin, Shown, clean_lines, make_run_page, tell_answer
from owtsweep.report.static_map import draw
from owtsweep.results.conditions import Value
from owtsweep.results.contents import Contents
from owtsweep.results.regret import SUMMARY, WORLDS
from owtsweep.sweep.asked import DETAILS, PAGE, find_home
from owtsweep.sweep.gather import Results
from owtsweep.sweep.manifest import read_manifest, without_places
from owtsweep.sweep.study import OK, Engine, Study, blame

if TYPE_CHECKING:
    from rich.console import RenderableType

#: What a page says where it has no stretch of a record.
HELP = (
    "A sweep keeps errors alone. `owtsweep report RUN --details`, with the folder of this run, "
    "runs the schemes on record 0 of each cell once more, and puts 40 s of it here, with error "
    "spectra where there are any."
)
#: Columns that say why a row has no number.
WHY = ("scheme", "status", "reason")
NO_STRETCH = "This study keeps errors alone."
#: The facts of a manifest that a page shows, in this order.
FACTS = {
    "owtsweep": "owtsweep", "python": "Python", "study": "study", "config_hash": "hash of the run",
    "seed": "seed", "started": "started", "ended": "ended", "seconds": "seconds",
}  # fmt: skip
#: Length of a stretch, s, and the most samples of a second that are kept.
SECONDS, RATE = 40.0, 10.0
#: Most bytes of a stored file.
MOST_BYTES = 50_000_000
#: Full scale of a number of 16 bits.
_FULL = 32767


def make_page(
    study: Study,
    config: Config,
    results: Mapping[str, Results],
    folder: Path,
    place: Path,
    missing: int = 0,
) -> str:
    """Return the page of a run as HTML.

    results: the results by tuning.
    folder: the run folder, or the folder of one of its questions.
    place: the folder of the run's tables and figures.
    missing: Number of the plan's blocks (units of work) that are not stored.
    Raises InputError if the study comes from another package and does not work.
    """
    with blame(study):
        engine = study.engine(config)
        kept = read_details(place)
        shown = {
            tuning: _show(engine, result, kept.get(tuning)) for tuning, result in results.items()
        }
        pictures = {
            path
            for tuning, result in results.items()
            if shown[tuning].contents is None
            for path in (place / "figures").glob(f"{engine.overview(result.config)}*.png")
        }
    name = printable((find_home(folder) or folder).name)
    tables = _gather_tables(results, shown, place)
    drawn = {printable(path.stem): path.read_bytes() for path in sorted(pictures)}
    help_ = HELP if study.stretched else NO_STRETCH
    with blame(study):
        names = study.explain_schemes()
    extras = Extras(tables, drawn, help_, names)
    title = f"Which estimator? Study {study.name}, run {name}"
    origin = _find_origin(folder, config)
    if missing:
        lost = {"incomplete": f"{missing} blocks of the plan are missing; run the sweep again"}
        origin = replace(origin, facts={**lost, **origin.facts})
    return make_run_page(title, shown, origin, extras, exact=not engine.samples)


def _show(engine: Engine, result: Results, details: object) -> Shown:
    contents = engine.contents(result.config, result.tables, result.rows)
    if contents is None:
        return Shown(text=_print(engine.terminal(result.config, result.tables)))
    return Shown(contents, details=details)


def _print(answer: RenderableType) -> str:
    from rich.console import Console

    printed = StringIO()
    Console(file=printed, width=80).print(answer)
    return printed.getvalue()


def _gather_tables(
    results: Mapping[str, Results], shown: Mapping[str, Shown], place: Path
) -> dict[str, pd.DataFrame]:
    tables = {}
    for tuning, part in shown.items():
        end = f", tuning {tuning}" if tuning else ""
        rows = results[tuning].rows
        without = rows.loc[rows["status"] != OK, [c for c in WHY if c in rows]].astype(str)
        if len(without):
            counts = without.value_counts(sort=False).rename("rows").reset_index()
            tables[f"Rows without a number{end}"] = counts
        summary = results[tuning].tables.get(SUMMARY)
        if summary is not None and len(summary):
            caption = f"Regret over what nobody knows (mean and worst over the worlds){end}"
            chosen = summary[summary["least_mean"] | summary["least_worst"]]
            tables[caption] = chosen.drop(columns=["criterion", "window"])
            tables[f"Worlds{end}"] = results[tuning].tables[WORLDS]
        claims = place / "fidelity" / tuning
        if (claims / "fidelity_claims.csv").is_file():
            tables[f"Claims of the paper{end}"] = read_table(claims, "fidelity_claims")
        if part.contents is None:
            of_tuning = results[tuning].tables.items()
            tables |= {f"Table {name}.csv{end}": table for name, table in of_tuning}
    return tables


def _find_origin(folder: Path, config: Config) -> Origin:
    import yaml

    try:
        manifest = read_manifest(folder)
    except InputError:  # a folder without one is still a run
        manifest = {}
    facts = {word: str(manifest[key]) for key, word in FACTS.items() if manifest.get(key)}
    match manifest.get("git"):
        case {"commit": commit, "dirty": dirty}:
            facts["commit"] = f"{commit}{' with changes' if dirty else ''}"
    match manifest.get("packages"):
        case dict(packages):
            facts["packages"] = ", ".join(f"{name} {version}" for name, version in packages.items())
    match manifest.get("argv"):
        case list(words):
            command = f"owtsweep {shlex.join(map(str, words))}"
        case _:
            command = "It was started from Python, with the configuration below."
    text = yaml.safe_dump(without_places(config), sort_keys=False, allow_unicode=True)
    return Origin(facts, command, text)


def make_excerpt(study: Study, config: Config, results: Mapping[str, Results], place: Path) -> str:
    """Return answer and map of each tuning as HTML for a notebook, with a link to the page."""
    with blame(study):
        engine = study.engine(config)
        parts = [_show(engine, result, None) for result in results.values()]
        shown = [
            f"<pre>{clean_lines(part.text)}</pre>"
            if part.contents is None
            else f"{tell_answer(part.contents)}\n{draw(part.contents)}"
            for part in parts
        ]
    page = place / PAGE
    link = f'<p><a href="{quote(str(page))}">{PAGE}</a></p>' if page.is_file() else ""
    return "\n".join([*shown, link])


def make_details(study: Study, config: AnyConfig, contents: Contents) -> dict[str, object]:
    """Run the schemes on record 0 of each cell, and return 40 s of each as plain JSON data.

    With them go the error spectra of the study, if it has any.

    config: the configuration, of one tuning.
    Returns: "label", and "cells": `at` (index of the value of each condition), `start` and `step`
        (s), and for truth and each scheme's error a name, a scale and numbers of 16 bits.
        "spectra": lines of scheme, measure, frequencies and errors; may be empty.
    Raises InputError if the study has no records to show, or a record cannot be made.
    """
    from joblib import Parallel, cpu_count, delayed

    if study.stretched is None:
        raise InputError(f"--details: the study {study.name} has no record to show")
    quantity, component, label = study.stretched
    cube = contents.cube
    levels = [list(enumerate(values)) for values in cube.levels]
    if cube.products is not None and cube.direct is None:
        levels[-1] = [levels[-1][0], levels[-1][-1]] if len(levels[-1]) > 1 else levels[-1]
    places = [dict(zip(cube.names, place, strict=True)) for place in product(*levels)]
    run = delayed(_run_cell)
    found = Parallel(n_jobs=min(cpu_count(), len(places)), return_as="generator")(
        run(study, config, place, quantity, component) for place in places
    )
    cells = []
    for number, cell in enumerate(found, start=1):
        tell_step(f"record {number} of {len(places)}")
        cells.append(cell)
    with blame(study):
        spectra = study.engine(config).spectra(config)
    return {"label": label, "cells": cells, "spectra": _list_spectra(spectra)}


def _list_spectra(table: pd.DataFrame | None) -> list[list[object]]:
    if table is None:
        return []
    return [
        [str(name), measure, _round(of_scheme["frequency"]), _round(of_scheme[measure])]
        for name, of_scheme in table.groupby("scheme", sort=False)
        for measure in table.columns[2:]
    ]


def _round(values: pd.Series[float]) -> list[float]:
    return [float(f"{value:.5g}") for value in values]


def _run_cell(
    study: Study,
    config: AnyConfig,
    place: Mapping[str, tuple[int, Value]],
    quantity: str,
    component: int,
) -> dict[str, object]:
    """Run record 0 of a cell; `place` has the index and the value of each condition."""
    grid = changed(config.grid, **{name: [value] for name, (_, value) in place.items()})
    with blame(study):
        record = study.estimate(changed(config, grid=grid), 0)
    step = float(record.time[1] - record.time[0])
    every = max(round(1.0 / (RATE * step)), 1)
    middle = (record.settled + len(record.time)) // 2
    first = min(middle, max(len(record.time) - round(SECONDS / step), 0))
    part = slice(first, first + round(SECONDS / step) + 1, every)
    truth = np.asarray(record.truth[quantity])[part, component]
    series = [pack("", truth)]
    for name, estimates in record.estimates.items():
        if quantity in estimates:
            error = np.asarray(estimates[quantity])[part, component] - truth
            if np.isfinite(error).all():
                series.append(pack(name, error))
    at, time = [index for index, _ in place.values()], float(record.time[first])
    return {"at": at, "start": time, "step": every * step, "series": series}


def pack(name: str, values: Array) -> list[object]:
    """Return name ("" for the truth), scale and numbers of 16 bits."""
    scale = float(np.abs(values).max(initial=0.0)) / _FULL or 1.0
    numbers = np.round(values / scale).astype("<i2")
    return [name, scale, base64.b64encode(numbers.tobytes()).decode()]


def dump_details(details: Mapping[str, object]) -> str:
    """Return the text of the file that keeps details by tuning."""
    return json.dumps(details) + "\n"


@dataclass
class _Cell:
    at: list[int]
    start: FiniteFloat
    step: FiniteFloat
    series: list[tuple[str, FiniteFloat, str]]


@dataclass
class _Details:
    label: str
    cells: list[_Cell]
    spectra: list[tuple[str, str, list[FiniteFloat], list[FiniteFloat]]]


def read_details(place: Path) -> dict[str, Any]:
    """Return what is kept of a run, by tuning; {} if nothing is.

    Raises InputError if the file, which may be another person's, holds anything else.
    """
    path = place / DETAILS
    if not path.is_file():
        return {}
    refusal = "this holds no details of a run; delete it, or write it again by --details"
    kept = read_as(dict[str, _Details], path, MOST_BYTES, refusal)
    return {tuning: asdict(details) for tuning, details in kept.items()}
