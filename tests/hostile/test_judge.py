"""`judge.judge` accepts a command that keeps the program's promises, and notices broken ones."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from judge import judge


def refuse(argv: list[str]) -> int:
    print("owtsweep: name: it is bad; give a good one", file=sys.stderr)
    return 2


def leave_a_file(argv: list[str]) -> int:
    Path("left").write_text("half")
    return refuse(argv)


def say_nothing(argv: list[str]) -> int:
    return 2


def print_an_escape(argv: list[str]) -> int:
    print("\x1b[31mred")
    return 0


def print_a_half_character(argv: list[str]) -> int:
    print("\udcff")
    return 0


def print_a_traceback(argv: list[str]) -> int:
    print("Traceback (most recent call last):", file=sys.stderr)
    return 2


def fail_without_a_reason(argv: list[str]) -> int:
    return 1


def end_otherwise(argv: list[str]) -> int:
    return 3


def raise_an_error(argv: list[str]) -> int:
    raise KeyError("name")


def run_a_command(argv: list[str]) -> int:
    os.system("true")
    return 0


def start_a_process(argv: list[str]) -> int:
    subprocess.run(["true"], check=True)
    return 0


def test_a_refusal_in_one_line_is_what_is_promised(tmp_path: Path) -> None:
    assert judge(refuse, [], tmp_path).code == 2


@pytest.mark.parametrize(
    "bad",
    [
        leave_a_file, say_nothing, print_an_escape, print_a_half_character, print_a_traceback,
        fail_without_a_reason, end_otherwise, raise_an_error, run_a_command, start_a_process,
    ],
)  # fmt: skip
def test_a_broken_promise_is_seen(
    bad: Callable[[list[str]], int], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(AssertionError):
        judge(bad, [], tmp_path)


def test_a_command_that_hangs_is_seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Also one that refuses whatever it cannot read."""

    def hang(argv: list[str]) -> int:
        try:
            time.sleep(10)
        except OSError:
            return refuse(argv)
        return 0

    monkeypatch.setattr("judge.PATIENCE", 1)
    with pytest.raises(pytest.fail.Exception, match="took more than 1 s"):
        judge(hang, [], tmp_path)
