"""The sweeps that README and pages tell to type have keys and values that are accepted."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest

from owtsweep.studies import compose

ROOT = Path(__file__).parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"^ *```\w*\n(.*?)^ *```", flags=re.DOTALL | re.MULTILINE)
COMMAND = re.compile(r"^ *(?:\$ )?owtsweep sweep\b(.*)$", flags=re.MULTILINE)
#: What only a multirun, a file of the user's or a machine of the user's gives a meaning.
ELSEWHERE = re.compile(r"hydra|\./|\$\(|_target_|recorded\.|motion\.file|\.\.\.")
#: A value of a multirun, and those after it.
SEVERAL = re.compile(r"(=[^,\[{'\"]+),.*")


def list_sweeps() -> dict[tuple[str, ...], str]:
    """Return the overrides of each sweep, of a multirun those of its first run -> its page."""
    found = {}
    for page in PAGES:
        blocks = BLOCK.findall(page.read_text("utf-8").replace("\\\n", " "))
        for line in COMMAND.findall("\n".join(blocks)):
            words = [] if ELSEWHERE.search(line) else shlex.split(line, comments=True)
            multirun = {"--multirun", "-m"} & set(words)
            overrides = [word for word in words if not word.startswith("-")]
            if overrides:
                first = (SEVERAL.sub(r"\1", word) if multirun else word for word in overrides)
                found[tuple(first)] = page.stem
    return found


SWEEPS = list_sweeps()


@pytest.mark.parametrize("overrides", SWEEPS, ids=" ".join)
def test_a_sweep_of_a_page_is_accepted(overrides):
    compose(list(overrides))


def test_many_pages_have_sweeps():
    assert len(set(SWEEPS.values())) > 10
