"""Saved figures: the same bytes for the same figure, small, and named after their run."""

from __future__ import annotations

import errno
import html

import matplotlib as mpl
import pytest

from owtsweep.errors import InputError
from owtsweep.figures import style
from owtsweep.io import files

TITLE = {"Title": "Several words to be outlined"}


def plain_figure():
    with style.context():
        figure = style.new_figure(6.0, 4.0)
        axes = figure.subplots()
        axes.plot([0.0, 1.0], [0.0, 1.0], label="a line")
        axes.set_title(TITLE["Title"])
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


def test_the_files_are_what_savefig_writes(tmp_path):
    saved = style.save(plain_figure(), tmp_path, "drawn")
    described = {"Date": None, "Description": "{}"}
    for file, options in zip(
        saved, ({"dpi": style.RESOLUTION, "metadata": TITLE}, {"metadata": described}), strict=True
    ):
        slow = tmp_path / f"slow{file.suffix}"
        with style.context():
            plain_figure().savefig(slow, **options)
        assert file.read_bytes() == slow.read_bytes()


def test_a_large_svg_is_written_again_with_letters_as_text(tmp_path, monkeypatch):
    figure = plain_figure()
    _, outlined = style.save(figure, tmp_path, "outlined")
    assert "<text" not in outlined.read_text(encoding="utf-8")
    monkeypatch.setattr(style, "SVG_LIMIT", outlined.stat().st_size - 1)
    _, written = style.save(figure, tmp_path, "written")
    assert "<text" in written.read_text(encoding="utf-8")
    assert written.stat().st_size < outlined.stat().st_size


NAMES = ("$\\frac{$", "a_b^c", "_under", "50 %$", "\\", "<b>&", "\N{HOUSE BUILDING}")


@pytest.mark.filterwarnings("error")
def test_names_are_drawn_as_typed_and_are_all_in_the_legend(tmp_path):
    with style.context():
        figure = style.new_figure(6.0, 4.0)
        axes = figure.subplots()
        axes.set_yscale("log")
        for number, name in enumerate(NAMES, 1):
            axes.plot([0, 1], [1, number], label=style.label_of(name))
        axes.set_xticks(range(len(NAMES)), list(NAMES))
        axes.set_title("log$_2$")
        legend = figure.legend(*axes.get_legend_handles_labels())
        figure.suptitle(" ".join(NAMES))
    style.save(figure, tmp_path, "named")
    shown = [text.get_text().removeprefix(style.JOINER) for text in legend.get_texts()]
    assert shown == list(NAMES)
    assert axes.title.get_parse_math()
    assert all(label.get_parse_math() for label in axes.get_yticklabels())  # powers of ten


@pytest.mark.parametrize("fails", ["fsync", "replace"])
def test_an_old_picture_stays_whole_if_the_disk_is_full(tmp_path, monkeypatch, fails):
    def refuse(*args):
        raise OSError(errno.ENOSPC, "No space left on device")

    figure = style.new_figure(2.0, 1.0)
    before = [path.read_bytes() for path in style.save(figure, tmp_path, "map", {"run": "old"})]
    monkeypatch.setattr(files.os, fails, refuse)
    with (
        pytest.raises(InputError, match=r"map\.png: cannot be written \(No space left on device\)"),
        files.refuse_in_one_line(tmp_path),
    ):
        style.save(figure, tmp_path, "map", {"run": "new"})
    assert [path.name for path in sorted(tmp_path.iterdir())] == ["map.png", "map.svg"]
    assert [path.read_bytes() for path in sorted(tmp_path.iterdir())] == before
