"""experiments/maes2018/figures.py: the paper's figures and the picture of the blade."""

from __future__ import annotations

from pathlib import Path

from experiments.maes2018.figures import FIGURES, draw_figures, draw_picture


def test_every_figure_is_drawn(tmp_path: Path) -> None:
    assert list(FIGURES) == [f"figure_{number}" for number in range(9, 14)]
    files = [
        *draw_figures(["figure_9", "figure_12", "figure_13"], tmp_path),
        *draw_picture(tmp_path),
    ]
    assert {file.suffix for file in files} == {".png", ".svg"}
    assert all(file.stat().st_size > 10_000 for file in files)
