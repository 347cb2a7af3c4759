"""The site's sources: every page has its place, the picture of the rooms is current."""

from __future__ import annotations

import re
import runpy
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
PARTS = ("index", "start", "howto", "explanation", "reference")


def list_entries(part: str) -> list[str]:
    """The entries of the tables of contents of a page."""
    text = (DOCS / f"{part}.md").read_text(encoding="utf-8")
    entries = []
    for block in re.findall(r"```\{toctree\}\n(.*?)```", text, re.DOTALL):
        lines = [line for line in block.splitlines() if line and not line.startswith(":")]
        entries += [line.partition("<")[2].rstrip(">") or line for line in lines]
    return entries


def test_every_page_has_one_place() -> None:
    entries = [entry for part in PARTS for entry in list_entries(part)]
    assert len(set(entries)) == len(entries)
    pages = {page.relative_to(DOCS).as_posix() for page in DOCS.rglob("*.md")} - {"index.md"}
    assert pages == {entry for entry in entries if entry.endswith(".md") and entry[:3] != "../"}


def test_the_picture_of_the_rooms_is_current() -> None:
    drawing = runpy.run_path(str(DOCS / "draw_rooms.py"))
    made = drawing["draw"](drawing["list_floors"]())
    assert drawing["FILE"].read_text(encoding="utf-8") == made, "run python docs/draw_rooms.py"


def test_dead_links_are_found(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.html").write_text(
        '<p id="here"><a href="#here"></a><a href="b.html#there"></a><img src="no.png">'
        '<a href="b.html#gone"></a><a href="https://example.org/x"></a><a href="b.html?q=1"></a>'
    )
    (tmp_path / "b.html").write_text('<p id="there">')
    main = runpy.run_path(str(DOCS / "check_links.py"))["main"]
    assert main(tmp_path) == 1
    assert capsys.readouterr().out.splitlines() == [
        "a.html: b.html#gone",
        "a.html: no.png",
        "5 links inside the site, 2 dead",
    ]
    (tmp_path / "a.html").unlink()
    assert main(tmp_path) == 0
