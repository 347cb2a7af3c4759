"""The pages hang together: links, lengths, headings, and what they name."""

from __future__ import annotations

import re
import tomllib
from itertools import pairwise
from pathlib import Path

import pytest

from owtsweep.config.hints import list_keys
from owtsweep.studies import compose
from owtsweep.studies.hub.config import HubConfig

ROOT = Path(__file__).parents[2]
PAGES = sorted((ROOT / "docs").rglob("*.md"))
#: These are looked things up in, not read.
REFERENCE = {"configuration", "faults", "files_of_a_case", "glossary", "recorded", "store"}
FENCED = re.compile(r"^ *```.*?^ *```$", flags=re.DOTALL | re.MULTILINE)


def read_prose(path: Path) -> str:
    """Return a page without its blocks of code."""
    return FENCED.sub("", path.read_text(encoding="utf-8"))


def list_anchors(path: Path) -> set[str]:
    """Return the anchors of a page's headings, as GitHub makes them."""
    headings = re.findall(r"^#+ (.*)$", read_prose(path), flags=re.MULTILINE)
    plain = (re.sub(r"\[([^]]*)\]\([^)]*\)", r"\1", heading).lower() for heading in headings)
    return {re.sub(r"[^\w\- ]", "", heading).strip().replace(" ", "-") for heading in plain}


def test_links_lead_somewhere():
    kept = (ROOT / "results" / "reference").rglob("*.md")
    for document in [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *PAGES, *kept]:
        for link in re.findall(r"\]\((?!https?:)([^)]+)\)", read_prose(document)):
            name, _, anchor = link.partition("#")
            target = (document.parent / name).resolve() if name else document
            assert target.exists(), f"{document.relative_to(ROOT)}: {link}"
            if anchor:
                assert anchor in list_anchors(target), f"{document.relative_to(ROOT)}: {link}"


def test_every_page_is_linked_from_the_readme_or_from_another():
    others = [ROOT / "README.md", ROOT / "CONTRIBUTING.md", *PAGES]
    for page in PAGES:
        linking = re.compile(rf"\]\([^)]*\b{re.escape(page.name)}")
        assert any(linking.search(o.read_text("utf-8")) for o in others if o != page), page.name


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_has_one_title_and_headings_in_order(page):
    levels = [len(marks) for marks in re.findall(r"^(#+) ", read_prose(page), flags=re.MULTILINE)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert all(after <= before + 1 for before, after in pairwise(levels))


def test_no_page_is_long_but_reference():
    long = {page.stem for page in PAGES if len(page.read_text("utf-8").split()) > 1800}
    assert long <= REFERENCE


def test_each_extra_that_is_named_is_declared_and_tested():
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"][
        "optional-dependencies"
    ]
    files = [ROOT / "README.md", *PAGES, *(ROOT / "src").rglob("*.py")]
    text = " ".join(file.read_text("utf-8") for file in files)
    named = set(re.findall(r"owtsweep\[(\w+)\]", text))
    assert "launchers" in named
    assert named <= set(extras)
    assert all(set(extras[name]) <= set(extras["test"]) for name in named - {"test", "bench"})


def test_what_the_paper_leaves_open_has_a_key():
    text = (ROOT / "docs/research/reproduction.md").read_text(encoding="utf-8")
    for key in re.findall(r"^\| `([\w.]+)`", text, flags=re.MULTILINE):
        assert key in list_keys(HubConfig), key


def test_the_scheme_of_the_page_is_the_tested_one():
    page = (ROOT / "docs/own_scheme.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(import numpy.*?)```", page, flags=re.DOTALL)
    tested = (ROOT / "tests/studies/hub/hold_last_fix.py").read_text(encoding="utf-8")
    _, _, code = tested.split('"""', 2)
    assert example.strip() == code.strip()


def test_what_the_pages_set_of_a_tower_is_accepted():
    text = (ROOT / "docs/tower.md").read_text(encoding="utf-8")
    overrides = re.findall(r"`(sensors\.[^`]*\])`", text)
    assert overrides
    for words in overrides:
        compose(["study=tower", *words.split()])  # refuses heights where no sensor can sit
