"""docs/replay.md, noise.md and research/replay.md run on the sample records as printed."""

from __future__ import annotations

import re
import shlex
from pathlib import Path

import pytest
from replay_tools import DATA, ROOT, needs_data

from owtsweep.cli import main
from owtsweep.studies.replay.files import MOTION, SENSORS, TABLE, write_sample
from owtsweep.sweep.runs import Run

PAGES = ("replay", "noise", "research/replay")
PAGE = "\n".join((ROOT / f"docs/{page}.md").read_text("utf-8") for page in PAGES)
LINES = re.findall(r"^owtsweep (replay .*)$", PAGE, flags=re.MULTILINE)
COMMANDS = [shlex.split(line, comments=True) for line in LINES]


@pytest.fixture
def sample(tmp_path, monkeypatch):
    """A folder with the sample, in which nothing is drawn: drawing takes most of the time."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(Run, "draw", lambda *args, **options: [])
    write_sample(tmp_path)


def test_every_command_of_the_page_runs_as_printed(sample, capsys):
    assert len(COMMANDS) >= 9
    printed = {}
    for words in COMMANDS:
        # fewer draws, to save time, but for the command whose last line the page shows
        as_printed = "--sample" in words or words == ["replay", MOTION]
        assert main(words if as_printed else [*words, "replay.replicates=2"]) == 0, words
        printed[shlex.join(words)] = capsys.readouterr()[0].splitlines()
    answer = "\n".join(printed[f"replay {MOTION}"][-3:])
    assert "Runner-up: " in answer
    assert f"```\n{answer}\n```" in PAGE


def test_the_python_code_of_the_page_runs(sample):
    (code,) = re.findall(r"```python\n(.*?)```", PAGE, flags=re.DOTALL)
    names: dict = {}
    exec(code, names)
    assert set(names["replay"].estimates().columns) >= {"time", "scheme", "x", "vy_std"}


@needs_data
@pytest.mark.faults  # slow: every command, on large files
def test_with_other_names_the_commands_run_on_other_files(sample):
    monopile, hand = DATA / "oc3_monopile_FAST_Test19.outb", DATA / "broad10_imu_optical.csv.gz"
    Path(TABLE).write_text(f"file,Hs\n{monopile},1\n{hand},2\n")
    both = f"{DATA}/*_*.*"
    for words in COMMANDS:
        swapped = [
            {MOTION: str(monopile), SENSORS: str(hand), "sample_*.csv": both}.get(
                word, word.replace("acc_x", "specific_force_x")
            )
            for word in words
        ]
        if "--sample" not in words:
            assert main(swapped) == 0, swapped
