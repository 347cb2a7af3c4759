"""Replace the measured parts of docs/scaling.md, which stand between marks that name them."""

from __future__ import annotations

from pathlib import Path

PAGE = Path(__file__).resolve().parents[1] / "docs" / "scaling.md"


def put(name: str, text: str) -> None:
    """Replace the part called `name` by `text`."""
    begin, end = f"<!-- {name}: begin -->\n", f"<!-- {name}: end -->\n"
    page = PAGE.read_text(encoding="utf-8")
    before, rest = page.split(begin)
    _, after = rest.split(end)
    PAGE.write_text(f"{before}{begin}{text}{end}{after}", encoding="utf-8")
