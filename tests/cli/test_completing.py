"""The shell completes commands, flags, studies, options and keys."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytest.importorskip("argcomplete")


def complete(line: str, folder: Path) -> list[str]:
    """What the shell is offered at the end of a line."""
    answer = folder / "answer"
    environment = os.environ | {
        "_ARGCOMPLETE": "1",
        "_ARGCOMPLETE_IFS": "\n",
        "_ARGCOMPLETE_COMP_WORDBREAKS": " ",
        "_ARGCOMPLETE_STDOUT_FILENAME": str(answer),
        "COMP_LINE": line,
        "COMP_POINT": str(len(line)),
    }
    command = [sys.executable, "-m", "owtsweep"]
    subprocess.run(command, env=environment, check=True, timeout=60.0, capture_output=True)
    return [word.strip() for word in answer.read_text(encoding="utf-8").splitlines()]


@pytest.mark.parametrize(
    ("line", "offered"),
    [
        ("owtsweep comp", ["compare"]),
        ("owtsweep sweep --dr", ["--dry-run"]),
        ("owtsweep sweep study=fl", ["study=floater"]),
        ("owtsweep sweep tuning=ma", ["tuning=matched"]),
        ("owtsweep sweep study=blade unit=ta", ["unit=tactical"]),
        ("owtsweep sweep sensors.gnss.del", ["sensors.gnss.delay="]),
        ("owtsweep sweep study=none tuning=ma", []),
        ("owtsweep init sch", ["scheme"]),
    ],
)
def test_a_word_is_completed(line: str, offered: list[str], tmp_path: Path) -> None:
    assert complete(line, tmp_path) == offered
