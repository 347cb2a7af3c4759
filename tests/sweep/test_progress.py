"""Progress: what a sweep tells, and what a terminal shows."""

from __future__ import annotations

import io
import sys

from rich.console import Console

from owtsweep.sweep.progress import BarProgress, SilentProgress, make_progress
from owtsweep.sweep.run import sweep


class Recorder:
    def __init__(self):
        self.calls = []

    def start(self, total_cases, reused):
        self.calls.append(("start", total_cases, reused))

    def advance(self, cases):
        self.calls.append(("advance", cases))

    def fail(self, label, reason):
        self.calls.append(("fail", label, reason))

    def stop(self):
        self.calls.append(("stop",))


def test_sweep_reports_every_case_once(faulty, config):
    sweep(faulty(), config(level=[1.0]))
    recorder = Recorder()
    sweep(faulty(**{"A2.0": "case", "B0.3": "raise"}), config(), progress=recorder)
    assert recorder.calls == [
        ("start", 12, 4),
        ("fail", "A2.0", "it diverged"),
        ("advance", 4),
        ("fail", "B0.3", "ArithmeticError: no convergence"),
        ("advance", 4),
        ("stop",),
    ]


def test_bar_shows_cases_and_failures():
    stream = io.StringIO()
    bar = BarProgress(Console(file=stream, force_terminal=True, width=120))
    bar.start(12, 4)
    bar.advance(8)
    bar.fail("A[b]", "it diverged")
    bar.stop()
    assert "12 of 12 cases" in stream.getvalue()
    assert "failed: A[b]: it diverged" in stream.getvalue()


def test_bar_only_where_somebody_sees_it(monkeypatch):
    class Terminal(io.StringIO):
        def isatty(self):
            return True

    monkeypatch.setattr(sys, "stderr", io.StringIO())
    assert isinstance(make_progress(quiet=False), SilentProgress)
    monkeypatch.setattr(sys, "stderr", Terminal())
    assert isinstance(make_progress(quiet=False), BarProgress)
    assert isinstance(make_progress(quiet=True), SilentProgress)
