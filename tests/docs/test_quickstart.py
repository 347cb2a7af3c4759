"""The walk of docs/quickstart.md: each command runs, and says what the page quotes.

The commands run with a small grid and short records, so numbers and winners differ from the page's.
Compared are the words between them.
"""

from __future__ import annotations

import contextlib
import io
import re
import shlex
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from owtsweep.cli.program import main
from owtsweep.sweep.runs import Run

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs/quickstart.md").read_text(encoding="utf-8")
BLOCKS = re.findall(r"^```(console|python|text)\n(.*?)^```", PAGE, flags=re.DOTALL | re.MULTILINE)
RECORDS = ["grid.natural_period=[4.0]", "record.duration=60"]
SMALL = {
    "sweep": [*RECORDS, "grid.amplitude=[0.01,0.5]", "grid.most=16",
              "compute.backend=threading", "compute.workers=1"],
    "tune": [*RECORDS, "tune.trials=1", "tune.replicates=2", "schemes=[MKF,HME1]"],
    "vary": ["record.duration=60", "schemes=[MKF,HME1]"],
}  # fmt: skip
#: What differs with the size of a run: numbers, names of schemes, marks, and folders' names.
VARYING = re.compile(r"(?:default|comparison|vary)-\w+|\b(?:EKF|MKF|HME[12]|NONE)\b|[^A-Za-z²√]+")


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def run_command(words: list[str]) -> str:
    """Return all that the program prints at a terminal, without colours."""
    screen = Terminal()
    with contextlib.redirect_stdout(screen), contextlib.redirect_stderr(screen):
        assert main(words) == 0, screen.getvalue()
    return re.sub(r"\x1b\[[\d;?]*[A-Za-z]", "", screen.getvalue())


def list_fragments(text: str) -> list[str]:
    """Return the words of a text between what varies with the size of a run, in their order."""
    parts = (" ".join(part.split()) for part in VARYING.split(text))
    return [part for part in parts if len(part) > 1]


@pytest.fixture
def walk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, kernels: None) -> Iterator[Path]:
    """An empty folder with the scheme of docs/own_scheme.md; `figures` draws a single figure."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("COLUMNS", "80")
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delitem(sys.modules, "mine", raising=False)
    page = (ROOT / "docs/own_scheme.md").read_text(encoding="utf-8")
    (example,) = re.findall(r"```python\n(import numpy.*?)```", page, flags=re.DOTALL)
    (tmp_path / "mine.py").write_text(example)
    draw = Run.draw

    def draw_less(run: Run, only: str = "figure_18_best_scheme", **asked: Any) -> list[Path]:
        return draw(run, None if asked else only, **asked)

    monkeypatch.setattr(Run, "draw", draw_less)
    yield tmp_path
    sys.modules.pop("mine", None)  # other tests have modules of this name


def test_every_command_of_the_page_says_what_the_page_quotes(walk):
    folders: dict[str, str] = {}
    printed = ""
    for kind, block in BLOCKS:
        if kind == "python":
            for told, made in folders.items():
                block = block.replace(told, made)
            screen = io.StringIO()
            with contextlib.redirect_stdout(screen):
                exec(block, {})
            printed = screen.getvalue()
            quoted = block = ""
        elif kind == "console":
            first, quoted = block.split("\n", 1)
            words = [word for word in shlex.split(first) if "PYTHONPATH" not in word]
            assert words[:2] == ["$", "owtsweep"]
            words = [folders.get(word, word) for word in words[2:]]
            printed = run_command([*words, *SMALL.get(words[0], [])])
            names = [re.findall(r"results/default-\w+", text)[-1:] for text in (quoted, printed)]
            folders |= dict(zip(*names, strict=False))
        else:
            quoted = block
        said = list_fragments(printed)
        for fragment in list_fragments(quoted):
            assert fragment in said, f"{fragment!r} is quoted, printed is:\n{printed}"
    named = re.findall(r"`(?:figures/)?(\w+\.(?:png|csv|yaml|py))`", PAGE)
    assert {"figure_18_best_scheme.png", "best_scheme.csv", "scheme_changes.csv"} <= set(named)
    for name in named:
        assert list(walk.rglob(name)), name


def test_the_first_folder_is_the_default_studys(walk):
    told = re.findall(r"results/default-\w+", PAGE)[0]
    assert f"folder  {told}/" in run_command(["sweep", "--dry-run"])
