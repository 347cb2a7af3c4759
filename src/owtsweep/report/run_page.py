"""Makes the page of a run: answer, map, cells, claims, where it comes from, how to repeat it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from string import Template

import pandas as pd

from owtsweep.figures.margin import FULL, PALEST
from owtsweep.report.data import make_part
from owtsweep.report.document import clean, make_page, make_picture, make_table, read_asset
from owtsweep.report.static_map import draw, list_legend
from owtsweep.results.conditions import show_value
from owtsweep.results.contents import Contents

#: Most rows of a table that stands there without JavaScript.
MOST_ROWS = 500


@dataclass(frozen=True)
class Shown:
    """What a run's page shows of one tuning.

    contents: what its study shows; None without a map.
    text: the answer as the terminal has it, where there are no contents.
    details: what is kept of a record over time; None without.
    """

    contents: Contents | None = None
    text: str = ""
    details: object = None


@dataclass(frozen=True)
class Origin:
    """Where a run comes from.

    facts: Name -> value: versions, seed, hash, dates.
    command: the command that makes the run again.
    config: the text of config.yaml.
    """

    facts: Mapping[str, str]
    command: str
    config: str


@dataclass(frozen=True)
class Extras:
    """What only some runs have.

    tables: Caption -> a table of its own, e.g. a paper's claims.
    pictures: Description -> PNG.
    help: how to get details, where there are none.
    names: Scheme -> what it is, in a few words.
    """

    tables: Mapping[str, pd.DataFrame] = field(default_factory=dict)
    pictures: Mapping[str, bytes] = field(default_factory=dict)
    help: str = ""
    names: Mapping[str, str] = field(default_factory=dict)


def make_run_page(
    title: str, shown: Mapping[str, Shown], origin: Origin, extras: Extras, *, exact: bool
) -> str:
    """Return the page of a run as HTML.

    shown: Tuning -> what is shown of it; the tuning is "" in a run of one.
    exact: whether the values are expected ones, and no samples of records.
    """
    mapped = {
        tuning: part.contents
        for tuning, part in shown.items()
        if part.contents is not None and len(part.contents.cells)
    }
    parts = [_write_answer(shown)]
    data = None
    if mapped:
        parts.append(_write_map(mapped, extras.names))
        make = partial(make_part, exact=exact, help=extras.help)
        made = [make(name, part, details=shown[name].details) for name, part in mapped.items()]
        data = {"parts": made, "shades": {"full": FULL, "palest": PALEST}}
    pictures = [make_picture(png, text) for text, png in extras.pictures.items()]
    if pictures:
        parts.append(write_section("Pictures", "".join(pictures)))
    for caption, table in extras.tables.items():
        parts.append(write_section(caption, scroll(caption, tabulate(caption, table))))
    parts.append(_write_origin(origin))
    return make_page(title, parts, data)


def _write_answer(shown: Mapping[str, Shown]) -> str:
    parts = []
    for tuning, part in shown.items():
        heading = f"<h2>Tuning {clean(tuning)}</h2>" if len(shown) > 1 else ""
        label = f"Answer, tuning {clean(tuning)}" if len(shown) > 1 else "Answer"
        parts.append(f'<section class="answer" aria-label="{label}">{heading}')
        if part.contents is None:
            parts.append(f"<pre>{clean_lines(part.text)}</pre>")
        else:
            parts.append(tell_answer(part.contents))
        parts.append("</section>")
    return "\n".join(parts)


def tell_answer(contents: Contents) -> str:
    """Return the answer of a study as HTML: sentences, then what they rest on."""
    lead, *others = [*contents.answer[:2], ""]
    sentences = [f'<p class="lead">{clean(" ".join([lead, *others]).strip())}</p>']
    sentences += [f"<p>{clean(sentence)}</p>" for sentence in contents.answer[2:]]
    return "\n".join([*sentences, f'<p class="origin">{clean("; ".join(contents.origin))}</p>'])


def clean_lines(text: str) -> str:
    """Return a text of several lines as HTML."""
    return "\n".join(clean(line) for line in text.splitlines())


def _write_map(mapped: Mapping[str, Contents], names: Mapping[str, str]) -> str:
    maps, rows = [], []
    for tuning, contents in mapped.items():
        criterion = next(iter(contents.criteria))
        named = f", tuning {tuning}" if tuning else ""
        by, window = contents.criteria[criterion].title, contents.window
        caption = f"Best scheme by {by}, {window} part of a record{named}"
        maps.append(
            f'<figure class="wide"><figcaption>{clean(caption)}</figcaption>'
            f"{draw(contents)}</figure>"
        )
        rows.append(_tabulate_cells(caption, contents, criterion))
    legend = [
        '<li><svg class="swatch" width="14" height="14" aria-hidden="true">'
        f'<rect width="14" height="14" fill="{color}"/></svg> {clean(name)}</li>'
        for name, color in list_legend(next(iter(mapped.values()))).items()
    ]
    return Template(read_asset("map.html")).substitute(
        maps="\n".join(maps),
        legend="\n".join(legend),
        rows="\n".join(rows),
        named="".join(
            f"<dt>{clean(name)}</dt><dd>{clean(names[name])}</dd>\n"
            for name in dict.fromkeys(n for each in mapped.values() for n in each.contenders)
            if name in names
        ),
    )


def _tabulate_cells(caption: str, contents: Contents, criterion: str) -> str:
    judged, names = contents.criteria[criterion], [each.name for each in contents.conditions]
    unit = f" ({judged.unit})" if judged.unit else ""
    titles = {
        **{condition.name: condition.title for condition in contents.conditions},
        "verdict": "verdict", "best": "best", "error_best": f"error{unit}",
        "error_low": "95 % from", "error_high": "to", "runner_up": "next best",
        "error_runner_up": f"its error{unit}",
    }  # fmt: skip
    cells = contents.cells.loc[contents.cells["criterion"] == criterion, [*titles]]
    shown = cells.assign(**{name: cells[name].map(show_value) for name in names})
    more = len(cells) - MOST_ROWS
    note = f'<p class="note">{more} more cells stand in best_scheme.csv.</p>' if more > 0 else ""
    return tabulate(caption, shown.rename(columns=titles)) + note


def tabulate(caption: str, table: pd.DataFrame) -> str:
    """Return a table as HTML, at most `MOST_ROWS` rows of it."""
    rows = [[show(value) for value in row] for row in table.head(MOST_ROWS).itertuples(index=False)]
    return make_table(caption, [str(name) for name in table.columns], rows)


def show(value: object) -> str:
    """Return a value of a table as text: three digits that count, and "–" for none."""
    if isinstance(value, float):
        return "–" if value != value else f"{value:.3g}"
    return str(value)


def scroll(name: str, content: str) -> str:
    """Return a wide element of a page in a frame that is scrolled, also by keys."""
    return f'<div class="wide" tabindex="0" role="group" aria-label="{clean(name)}">{content}</div>'


def write_section(title: str, content: str) -> str:
    """Return a section of a page; `content` is HTML."""
    return f"<section><h2>{clean(title)}</h2>\n{content}</section>"


def _write_origin(origin: Origin) -> str:
    facts = "".join(
        f"<dt>{clean(name)}</dt><dd>{clean(value)}</dd>" for name, value in origin.facts.items()
    )
    return (
        "<section><h2>Where this comes from</h2>\n"
        f"<dl>{facts}</dl>\n<h3>The command that makes it again</h3>\n"
        f"<pre>{clean_lines(origin.command)}</pre>\n"
        "<details><summary>Configuration</summary>"
        f"<pre>{clean_lines(origin.config)}</pre></details></section>"
    )
