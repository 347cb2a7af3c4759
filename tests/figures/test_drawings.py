"""Figures by name: all that a run can have, or one."""

from __future__ import annotations

import logging
from contextlib import contextmanager

import pytest

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.figures.drawings import draw_each, save_figure


def refuse(folder, name):
    raise InputError("schemes: none")


def leave(folder, name):
    path = folder / f"{name}.txt"
    path.write_text(name)
    return [path]


def test_all_are_drawn_and_what_cannot_be_is_left_out(tmp_path, caplog):
    with caplog.at_level(logging.WARNING):
        files = draw_each({"one": leave, "none": refuse, "two": leave}, tmp_path, None)
    assert [file.name for file in files] == ["one.txt", "two.txt"]
    assert "none is left out: schemes: none" in caplog.text


def test_one_is_drawn_by_name_or_refused(tmp_path):
    drawings = {"one": leave, "none": refuse}
    assert [file.name for file in draw_each(drawings, tmp_path, "one")] == ["one.txt"]
    with pytest.raises(InputError, match=r"^schemes: none$"):
        draw_each(drawings, tmp_path, "none")
    with pytest.raises(InputError, match=r"^only: this run has no figure 'two'; use one, none$"):
        draw_each(drawings, tmp_path, "two")


def test_a_figure_is_drawn_in_the_style_and_saved_under_its_name(tmp_path):
    drawing = save_figure(lambda: style.new_figure(2.0, 1.0), {"run": "3f2a"})
    assert [file.name for file in drawing(tmp_path, "empty")] == ["empty.png", "empty.svg"]
    assert b"run\x003f2a" in (tmp_path / "empty.png").read_bytes()


def test_what_another_package_draws_is_drawn_under_its_guard(tmp_path, caplog):
    def fail(folder, name):
        return {}["means"]

    @contextmanager
    def blame():
        try:
            yield
        except KeyError as error:
            raise InputError(f"package: {error}") from error

    drawn = draw_each({"none": fail, "one": leave}, tmp_path, None, blame)
    assert [file.name for file in drawn] == ["one.txt"]
    assert "none is left out: package: 'means'" in caplog.text
