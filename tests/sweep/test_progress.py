"""Progress: what a sweep tells, and what a terminal shows."""

from __future__ import annotations

import io
import os
import sys

import pytest
from rich.console import Console

from owtsweep.compiled import COMMAND
from owtsweep.sweep import progress
from owtsweep.sweep.progress import ConsoleProgress, make_progress
from owtsweep.sweep.run import sweep


def make(stream, clock=None, terminal=False):
    console = Console(file=stream, force_terminal=terminal, width=120, get_time=clock)
    return ConsoleProgress(console)


class Recorder:
    def __init__(self):
        self.calls = []

    def start(self, total_cases, reused):
        self.calls.append(("start", total_cases, reused))

    def advance(self, cases):
        self.calls.append(("advance", cases))

    def fail(self, label, reason, cases):
        self.calls.append(("fail", label, reason, cases))

    def stop(self):
        self.calls.append(("stop",))


def test_sweep_reports_every_case_once(faulty, config):
    sweep(faulty(), config(level=[1.0]))
    recorder = Recorder()
    sweep(faulty(**{"A2.0": "case", "B0.3": "raise"}), config(), progress=recorder)
    first, *between, last = recorder.calls
    assert (first, last) == (("start", 12, 4), ("stop",))
    assert sorted(between) == [  # a thread tells the next block while the failures are listed
        ("advance", 2),
        ("advance", 2),
        ("advance", 2),
        ("advance", 2),
        ("fail", "A2.0", "it diverged", 1),
        ("fail", "B0.3", "ArithmeticError: no convergence", 2),
    ]


def test_bar_shows_cases_and_failures():
    stream = io.StringIO()
    bar = make(stream, terminal=True)
    bar.start(12, 4)
    bar.advance(8)
    for _ in range(3):
        bar.fail("A[b]", "it diverged", 2)
    bar.stop()
    assert "12 of 12 cases" in stream.getvalue()
    assert "12 of 12 cases, 6 failed" in stream.getvalue()
    assert stream.getvalue().count("failed: A[b]: it diverged") == 1  # not a line per failure


def test_bar_shows_rate_and_time_left():
    now = [0.0]
    stream = io.StringIO()
    bar = make(stream, clock=lambda: now[0], terminal=True)
    bar.start(278_000, 0)
    bar.advance(1)
    now[0] = 100.0
    bar.advance(138_999)
    bar.stop()
    assert "139000 of 278000 cases, 0 failed, 1 390 cases/s, 2 min left" in stream.getvalue()


def test_bar_only_where_somebody_sees_it(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setenv("FORCE_COLOR", "1")  # of an automatic run: its log is no terminal
    for kind, bar in [(io.StringIO, False), (Terminal, True)]:
        stream = kind()
        monkeypatch.setattr(sys, "stderr", stream)
        shown = make_progress()
        shown.start(12, 4)
        shown.stop()
        assert ("\x1b" in stream.getvalue()) == bar


def test_lines_come_every_30_seconds_with_rate_and_time_left(monkeypatch):
    now = [100.0]
    stream = io.StringIO()
    lines = make(stream, clock=lambda: now[0])
    waits = []

    def wait(seconds):
        waits.append(seconds)
        now[0] += seconds
        if len(waits) == 1:
            lines.advance(100)
            lines.fail("A", "it diverged", 3)
        return len(waits) > 2

    monkeypatch.setattr(lines._over, "wait", wait)
    monkeypatch.setattr(progress.threading, "Thread", lambda target, daemon: Here(target))
    lines.start(1000, 200)
    lines.stop()
    assert waits == [30.0] * 3
    assert stream.getvalue().splitlines() == [
        "1000 cases, 200 of them stored already",
        "300 of 1000 cases, 3 failed, 3.33 cases/s, 4 min left",
        "300 of 1000 cases, 3 failed, 1.67 cases/s, 7 min left",
        "300 of 1000 cases, 3 failed, 1.11 cases/s, 10 min left",
    ]


class Here:
    """A thread that does its work at its start."""

    def __init__(self, target):
        self.start = target


@pytest.mark.parametrize(
    ("cases", "rate"),
    [(139_049, "1 390 cases/s"), (123_456_789, "1 230 000 cases/s"), (99_960, "1 000 cases/s")],
)
def test_a_high_rate_is_told_in_digits(cases, rate):
    now = [0.0]
    stream = io.StringIO()
    lines = make(stream, clock=lambda: now[0])
    lines.start(2 * cases, 0)
    lines.advance(cases)
    now[0] = 100.0
    lines.stop()
    assert f" failed, {rate}, 2 min left" in stream.getvalue()


def test_a_stream_that_is_gone_does_not_stop_a_sweep(study, config):
    stream = io.StringIO()
    stream.close()
    assert sweep(study, config(), progress=make(stream)).computed == 12


@pytest.mark.parametrize("backend", ["threading", "loky"])
def test_every_backend_tells_all_cases(faulty, config, backend):
    recorder = Recorder()
    study = faulty(**{"A2.0": "case", "B0.3": "raise"})
    sweep(study, config(backend=backend, workers=2), progress=recorder)
    assert sum(call[1] for call in recorder.calls if call[0] == "advance") == 12
    assert sum(call[3] for call in recorder.calls if call[0] == "fail") == 3


def test_workers_know_the_command_that_they_belong_to(study, config, monkeypatch):
    """So that one of them tells of compiling, not each."""
    monkeypatch.setenv(COMMAND, "")  # so that it is restored
    monkeypatch.delenv(COMMAND)
    sweep(study, config(backend="loky", workers=2))
    assert os.environ[COMMAND].startswith(f"{os.getpid()}-")
