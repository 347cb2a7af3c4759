"""Write docs/configuration.md: `python docs/make_configuration.py`.

The page is made from the pydantic models of all studies' configurations. It lists the type, unit,
default, bounds and meaning of each key.
"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from owtsweep.config import Config
from owtsweep.config.reference import KeyFacts, describe_keys
from owtsweep.config.typed import as_mapping
from owtsweep.io.markdown import table
from owtsweep.studies.registry import OURS, compose

INTRODUCTION = """\
# Configuration

Every key of every study. Set one by `key=value` on the command line, e.g.
`sensors.gnss.delay=0.4`; the defaults are those of a run without overrides. Units are SI,
angles are in degrees. `owtsweep sweep --help study=NAME` prints the keys of one study. With
several tunings, the defaults of `ekf` to `hme` are those of the first.

An *axis* is a list whose entries are numbers, `{log: [first, last, count]}` or
`{linear: [first, last, count]}`: `'grid.amplitude=[{log:[0.05,10,100]},20]'` (in quotes, because
of the shell) gives 100 amplitudes from 0.05 m to 10 m, each the same factor above the one before,
and 20 m. Numbers between the ends are rounded to 12 digits. `config.yaml` stores the numbers.

The magnitude of a number other than 0 lies between 1e-30 and 1e30: beyond them, squares of squares
cannot be computed with. Grids, windows and horizons that would need more than 4 GB are refused.

What nobody knows may be an axis too: `over={world: [...]}` ([regret.md](regret.md)).

This page is written by `python docs/make_configuration.py`."""

COLUMNS = ("key", "type", "unit", "default", "bounds", "meaning")
#: One row of a table of the page, about one key: the texts of the `COLUMNS`.
Row = tuple[str, ...]


def reference() -> str:
    """Return the page on all configuration keys, as Markdown.

    The keys that all studies share come first. Then come, for each built-in study, the keys that
    this study adds or changes.
    """
    seen = dict.fromkeys(_describe(Config, as_mapping(Config(study="")))[1:])
    sentence = "`study=NAME` says which; without it the study is `hub`."
    parts = [INTRODUCTION, "## Every study", sentence, table(COLUMNS, seen)]
    for name, entry in OURS.items():
        config = compose([f"study={name}"], primary=entry.primary)
        first = next(iter(config.by_tuning().values()))  # of several tunings, for its sections
        defaults = {**as_mapping(first), **as_mapping(config)}
        rows = [row for row in _describe(type(config), defaults) if row not in seen]
        seen |= dict.fromkeys(rows)
        sentence = "What it adds or changes, besides the keys above."
        parts += [f"## `{name}`", sentence, table(COLUMNS, rows)]
    return "\n\n".join(parts) + "\n"


def _describe(model: Any, defaults: Mapping[str, Any]) -> list[Row]:
    """Return a row of the page's tables for each key of a model, including keys of its sections."""
    return [_make_row(facts) for facts in describe_keys(model, defaults)]


def _make_row(facts: KeyFacts) -> Row:
    default = f"`{facts.default}`" if facts.default else facts.default
    if default is None:
        default = "shown by `--cfg`"
    bounds = [f"`{bound}`" if facts.type == "choice" else bound for bound in facts.bounds]
    return (
        f"`{facts.key}`", *facts[1:3], default, ", ".join(bounds), facts.meaning,
    )  # fmt: skip


if __name__ == "__main__":
    Path(__file__).with_name("configuration.md").write_text(reference(), encoding="utf-8")
