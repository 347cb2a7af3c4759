"""Fixtures of the sweep's tests."""

from __future__ import annotations

import signal
from collections.abc import Callable
from pathlib import Path

import pytest
from dummy_study import DummyConfig, DummyStudy, make_config

from owtsweep import studies
from owtsweep.studies import registry

# Whoever starts the tests in the background leaves Ctrl-C ignored to all that they start.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture
def study() -> DummyStudy:
    return DummyStudy()


@pytest.fixture
def faulty() -> Callable[..., DummyStudy]:
    """A study with faults: `faulty(**{"A1.0": "raise"})`."""
    return lambda **faults: DummyStudy(faults)


@pytest.fixture
def config(tmp_path: Path) -> Callable[..., DummyConfig]:
    """A configuration whose results lie in the test's own folder."""
    return lambda **changes: make_config(changes.pop("results", tmp_path / "results"), **changes)


@pytest.fixture
def known_study(monkeypatch: pytest.MonkeyPatch, study: DummyStudy) -> DummyStudy:
    """The study, found by `get_study` too."""
    for module in (studies, registry):
        monkeypatch.setattr(module, "get_study", lambda name: study)
    return study
