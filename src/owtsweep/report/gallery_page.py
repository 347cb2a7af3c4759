"""Makes the index of a folder of figures: a small picture and a sentence for each."""

from __future__ import annotations

from collections.abc import Sequence
from io import BytesIO
from pathlib import Path
from urllib.parse import quote

from owtsweep.errors import printable
from owtsweep.report.document import clean, make_page, make_picture

INDEX = "index.html"
#: Width of a small picture, in pixels.
WIDTH = 480


def make_gallery(title: str, figures: Sequence[Path]) -> str:
    """Return the index of figures as HTML.

    figures: PNG files that lie beside the index, the most useful one first. The sentence is the
        title stored in the file.
    """
    items = "".join(_show(path) for path in figures)
    return make_page(title, [f'<ul class="gallery">{items}</ul>'])


def _show(path: Path) -> str:
    from PIL import Image

    with Image.open(path) as picture:
        title = str(picture.info.get("Title", ""))
        small = picture.convert("RGB")
    small.thumbnail((WIDTH, 2 * WIDTH))
    written = BytesIO()
    small.save(written, "PNG", optimize=True)  # fewer colours would be others than the legend's
    sentence = title or printable(path.stem).replace("_", " ")
    return (
        f'<li><a href="{quote(path.name)}">{make_picture(written.getvalue(), sentence)}</a>'
        f'<p>{clean(sentence)}</p><p class="note">{clean(path.stem)}: '
        f'<a href="{quote(path.name)}">PNG</a>, '
        f'<a href="{quote(path.with_suffix(".svg").name)}">SVG</a></p></li>'
    )
