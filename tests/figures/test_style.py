"""Saved figures: the same bytes for the same figure, small, and named after their run."""

from __future__ import annotations

import html

import matplotlib as mpl

from owtsweep.figures import style


def plain_figure():
    with style.context():
        figure = style.new_figure(6.0, 4.0)
        axes = figure.subplots()
        axes.plot([0.0, 1.0], [0.0, 1.0], label="a line")
        axes.set_title("Several words to be outlined")
        axes.legend()
    return figure


def test_saved_files_are_small_reproducible_and_know_their_run(tmp_path, monkeypatch):
    monkeypatch.setitem(mpl.rcParams, "font.size", 7.0)  # a setting of the user's
    before = dict(mpl.rcParams)
    saved = []
    for folder in ("one", "other"):
        saved.append(style.save(plain_figure(), tmp_path / folder, "map", {"run": "3f2a"}))
    assert dict(mpl.rcParams) == before
    for one, other in zip(*saved, strict=True):
        assert one.read_bytes() == other.read_bytes()
    png, svg = saved[0]
    assert (png.name, svg.name) == ("map.png", "map.svg")
    assert b"run\x003f2a" in png.read_bytes()
    text = svg.read_text(encoding="utf-8")
    assert '{"run": "3f2a"}' in html.unescape(text)
    assert "<dc:date>" not in text
    assert svg.stat().st_size < 500 * 1024


def test_a_large_svg_is_written_again_with_letters_as_text(tmp_path, monkeypatch):
    figure = plain_figure()
    _, outlined = style.save(figure, tmp_path, "outlined")
    assert "<text" not in outlined.read_text(encoding="utf-8")
    monkeypatch.setattr(style, "SVG_LIMIT", outlined.stat().st_size - 1)
    _, written = style.save(figure, tmp_path, "written")
    assert "<text" in written.read_text(encoding="utf-8")
    assert written.stat().st_size < outlined.stat().st_size
