"""Replace the measured parts of pages, which stand between marks that name them."""

from __future__ import annotations

from pathlib import Path

from benchmarks import ROOT

DOCS = ROOT / "docs"


def put(name: str, text: str, path: Path = DOCS / "scaling.md") -> None:
    """Replace the part called `name` of the page `path` by `text`, of whole lines."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->\n"
    page = path.read_text(encoding="utf-8")
    before, rest = page.split(begin)
    _, after = rest.split(end)
    path.write_text(f"{before}{begin}{text}{end}{after}", encoding="utf-8")
