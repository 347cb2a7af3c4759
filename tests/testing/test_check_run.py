"""A study that shows nothing in the terminal is told so: at its end a sweep prints it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from dummy_study import DummyStudy, make_config

from owtsweep.testing.studies import check_run


def test_the_terminal_is_tried(tmp_path: Path) -> None:
    class Silent(DummyStudy):
        def terminal(self, config: Any, tables: Any) -> str:
            return ""

    check_run(DummyStudy(), make_config(tmp_path / "good"))
    with pytest.raises(AssertionError, match=r"^dummy: the terminal shows nothing$"):
        check_run(Silent(), make_config(tmp_path / "bad"))
