"""Steps of a command are told on a terminal only."""

from __future__ import annotations

import io

import pytest

from owtsweep.figures.drawings import draw_each
from owtsweep.io.terminal import show_steps, tell_step


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


@pytest.mark.parametrize("stream", [Terminal(), io.StringIO()])
def test_each_figure_is_told_on_a_terminal_and_nothing_elsewhere(stream, monkeypatch, tmp_path):
    monkeypatch.setattr("sys.stderr", stream)
    drawings = {name: lambda folder, name: [] for name in ("map", "curves[3]")}
    with show_steps():
        draw_each(drawings, tmp_path, None)
    tell_step("unheard")
    told = "figure 1 of 2: map\nfigure 2 of 2: curves[3]\n"
    assert stream.getvalue() == (told if stream.isatty() else "")
