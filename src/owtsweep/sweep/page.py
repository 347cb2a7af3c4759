"""Gathers what the page of a run shows: results, claims, and where they come from."""

from __future__ import annotations

import shlex
from collections.abc import Mapping
from dataclasses import replace
from io import StringIO
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

import pandas as pd

from owtsweep.config import Config
from owtsweep.errors import InputError, printable
from owtsweep.io.tables import read_table
from owtsweep.report.run_page import Extras, Origin, Shown, clean_lines, make_run_page, tell_answer
from owtsweep.report.static_map import draw
from owtsweep.results.regret import SUMMARY, WORLDS
from owtsweep.sweep.asked import PAGE, find_home
from owtsweep.sweep.details import read_details
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
