"""Fixtures of the command line's tests."""

from __future__ import annotations

import pytest

from owtsweep.sweep.runs import Run


@pytest.fixture
def undrawn(monkeypatch: pytest.MonkeyPatch) -> None:
    """No map is drawn after a run, which takes longer than a small run."""
    monkeypatch.setattr(Run, "draw", lambda *words, **options: [])
