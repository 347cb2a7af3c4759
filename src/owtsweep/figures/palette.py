"""The style of each scheme, i.e. colour, marker and line style, equal in all figures and tables.

Colours are those of Okabe and Ito (2008), which colour-blind readers can distinguish. A marker and
a line style distinguish schemes in black and white.
"""

from __future__ import annotations

import colorsys
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Literal

from owtsweep.errors import InputError

__all__ = ["SchemeStyle", "style_of"]

LineStyle = Literal["-"] | tuple[int, tuple[int, ...]]


@dataclass(frozen=True)
class SchemeStyle:
    """The style of a scheme: colour "#RRGGBB", and marker and line in matplotlib's notation."""

    color: str
    marker: str
    line: LineStyle


#: Scheme -> the style that a study has reserved for it.
_reserved: dict[str, SchemeStyle] = {}
#: Okabe and Ito's other colours, for schemes without a reserved style.
SPARE_COLORS = ("#56B4E9", "#D55E00", "#F0E442")
SPARE_MARKERS = ("v", "P", "X", "<", ">", "p", "h")
SPARE_LINES: tuple[LineStyle, ...] = (
    (0, (1, 1)),
    (0, (3, 1, 1, 1, 1, 1)),
    (0, (8, 3)),
    (0, (2, 2)),
)


def reserve(styles: Mapping[str, SchemeStyle]) -> None:
    """Reserve styles for schemes, by name; a name that has a style keeps it."""
    for name, style in styles.items():
        _reserved.setdefault(name, style)


def style_of(name: str, all_names: Sequence[str]) -> SchemeStyle:
    """Return the style of the scheme `name` in a study whose schemes are `all_names`.

    Schemes without a reserved style get further colours, markers and line styles, in the order of
    `all_names`. Raise `InputError` if `name` has no reserved style and is not one of `all_names`.
    """
    if name in _reserved:
        return _reserved[name]
    others = [other for other in dict.fromkeys(all_names) if other not in _reserved]
    if name not in others:
        raise InputError(f"scheme: {name!r} is none of {', '.join(all_names)}")
    index = others.index(name)
    return SchemeStyle(
        color=_spare_color(index),
        marker=SPARE_MARKERS[index % len(SPARE_MARKERS)],
        line=SPARE_LINES[index % len(SPARE_LINES)],
    )


def text_color_on(color: str) -> str:
    """Return black or white ("#000000", "#ffffff") for text on the fill "#RRGGBB".

    It is the one with more contrast (WCAG 2).

    The ratio is at least 4.58 on any fill.
    """
    return "#000000" if (relative_luminance(color) + 0.05) ** 2 > 0.05 * 1.05 else "#ffffff"


def mix_with_white(color: str, share: float) -> str:
    """Return a paler "#RRGGBB": `share` of `color`, from 0 to 1, and the rest white."""
    return _as_hex(1.0 - share * (1.0 - channel) for channel in channels_of(color))


def relative_luminance(color: str) -> float:
    """Compute the relative luminance of "#RRGGBB", from 0 (black) to 1 (white), as in WCAG 2."""
    channels = channels_of(color)
    linear = [c / 12.92 if c <= 0.04045 else ((c + 0.055) / 1.055) ** 2.4 for c in channels]
    return 0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2]


def channels_of(color: str) -> tuple[float, float, float]:
    """Return red, green and blue of "#RRGGBB", from 0 to 1."""
    red, green, blue = (int(color[start : start + 2], 16) / 255.0 for start in (1, 3, 5))
    return red, green, blue


def _spare_color(index: int) -> str:
    if index < len(SPARE_COLORS):
        return SPARE_COLORS[index]
    # steps of the golden section never repeat a hue; the lightness alternates
    step = index - len(SPARE_COLORS)
    channels = colorsys.hls_to_rgb((0.08 + 0.618034 * step) % 1.0, (0.3, 0.55, 0.75)[step % 3], 0.5)
    return _as_hex(channels)


def _as_hex(channels: Iterable[float]) -> str:
    return "#" + "".join(f"{round(255 * channel):02X}" for channel in channels)
