"""Every scheme has one look, in colour and in black and white."""

from __future__ import annotations

import pytest
from looks import LOOKS

from owtsweep.errors import InputError
from owtsweep.figures import palette
from owtsweep.figures.palette import SchemeStyle, relative_luminance, style_of, text_color_on

SCHEMES = list(LOOKS)


def test_every_scheme_has_a_look_of_its_own():
    names = [*SCHEMES, *(f"user{number}" for number in range(40))]
    looks = [style_of(name, names) for name in names]
    assert len({look.color for look in looks}) == len(names)
    paper = looks[:4]
    assert len({look.marker for look in looks[:11]}) == 11
    assert len({look.line for look in paper}) >= 3
    for look in looks:
        assert contrast(look.color, text_color_on(look.color)) >= 4.5
    assert style_of("user0", ["user0", "MKF"]) == style_of("user0", names)
    with pytest.raises(InputError, match=r"^scheme: 'nobody' is none of"):
        style_of("nobody", SCHEMES)


def contrast(one: str, other: str) -> float:
    low, high = sorted((relative_luminance(one), relative_luminance(other)))
    return (high + 0.05) / (low + 0.05)


def test_a_reserved_look_is_kept_for_good(monkeypatch):
    monkeypatch.setattr(palette, "_reserved", {})
    free = style_of("filter", ["filter", "other"])
    reserved = SchemeStyle("#000000", "s", "-")
    palette.reserve({"filter": reserved})
    palette.reserve({"filter": SchemeStyle("#FFFFFF", "o", "-")})
    assert style_of("filter", ["filter", "other"]) == reserved
    assert style_of("other", ["filter", "other"]) == free  # the first free look, of the others
