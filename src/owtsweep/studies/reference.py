"""Write docs/configuration.md: `python -m owtsweep.studies.reference docs/configuration.md`."""

from __future__ import annotations

import sys
from pathlib import Path

from owtsweep.config import Config
from owtsweep.config.identity import as_plain
from owtsweep.config.reference import Row, describe, page
from owtsweep.studies.composing import compose
from owtsweep.studies.registry import OURS

INTRODUCTION = """\
# Configuration

Every key of every study. Set one by `key=value` on the command line, e.g.
`sensors.gnss.delay=0.4`; the defaults are those of a run without overrides. Units are SI, angles
are in degrees.

An *axis* is a list whose entries are numbers, `{log: [first, last, count]}` or
`{linear: [first, last, count]}`: `'grid.amplitude=[{log:[0.05,10,100]},20]'` (in quotes, because
of the shell) gives 100 amplitudes from 0.05 m to 10 m, each the same factor above the one before,
and 20 m. Numbers between the ends are rounded to 12 digits. `config.yaml` stores the numbers.

This page is written by `python -m owtsweep.studies.reference docs/configuration.md`."""


def reference() -> str:
    """The page: keys of all studies, then the keys that each built-in study adds or changes."""
    common = describe(Config, as_plain(Config(study="")))[1:]
    chapters: dict[str, tuple[str, list[Row]]] = {
        "Every study": ("`study=NAME` says which; without it the study is `hub`.", common)
    }
    seen = set(common)
    for name, entry in OURS.items():
        config = compose([f"study={name}"], primary=entry.primary)
        rows = [row for row in describe(type(config), as_plain(config)) if row not in seen]
        seen |= set(rows)
        chapters[f"`{name}`"] = ("What it adds or changes, besides the keys above.", rows)
    return page(chapters, INTRODUCTION)


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(reference(), encoding="utf-8")
