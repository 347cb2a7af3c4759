"""docs/configuration.md is what the models declare."""

from __future__ import annotations

import runpy
from pathlib import Path

from owtsweep.config.hints import list_keys
from owtsweep.studies.registry import OURS, find_tree

DOCS = Path(__file__).parents[2] / "docs"
PAGE = DOCS / "configuration.md"
reference = runpy.run_path(str(DOCS / "make_configuration.py"))["reference"]


def test_the_page_is_up_to_date() -> None:
    written = PAGE.read_text(encoding="utf-8")
    assert written == reference(), "run python docs/make_configuration.py"


def test_every_key_has_a_meaning() -> None:
    rows = [line.split(" | ") for line in reference().splitlines() if line.startswith("| `")]
    meanings = {cells[0].strip("|` "): cells[-1].strip("| ") for cells in rows}
    for name in OURS:
        assert all(meanings.get(key) for key in list_keys(find_tree(name).model))
