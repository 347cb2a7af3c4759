"""Plain data becomes a frozen object, or one line says what is wrong with it."""

from __future__ import annotations

from typing import Literal

import pytest
from pydantic import ValidationError

from owtsweep.config import (
    Axis,
    Config,
    NotNegative,
    Positive,
    Section,
    changed,
    checked,
    dump,
    key,
    typed,
    with_values,
)  # fmt: skip
from owtsweep.config.hints import explain_unknown_key
from owtsweep.config.section import unit_of
from owtsweep.config.stored import read_stored
from owtsweep.errors import InputError


class Inner(Section):
    """A section."""

    sigma: Positive = key("a number", unit="m", default=1.0)
    delay: NotNegative | None = key("a number or null", unit="s", default=None)
    on: bool = key("true or false", default=False)


class Model(Config):
    """Keys of several types."""

    inner: Inner = key("a section", default=Inner())
    kind: Literal["a", "b"] = key("one of two", default="a")
    count: int = key("a whole number", default=3, ge=1, le=9, unit="steps")
    ratio: Positive = key("a number below one", default=0.5, lt=1.0)
    label: str = key("a text", default="")
    kinds: list[Literal["a", "b"]] = key("some of two", default=["a"])
    pair: list[Positive] = key(
        "two", default=[1.0, 2.0], form="two numbers", min_length=2, max_length=2
    )
    section: Inner | None = key("a section or null", default=None)


def make(**values: object) -> Model:
    return typed(Model, {"study": "x", **values})


@pytest.mark.parametrize(
    ("value", "expected"), [(3.0, 3), ("3", 3), (True, None), (2.5, None), ("x", None)]
)
def test_whole_numbers(value: object, expected: int | None) -> None:
    if expected is None:
        with pytest.raises(InputError, match=rf"^count: {value!r} is not a whole number$"):
            make(count=value)
    else:
        assert make(count=value).count == expected


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("label", True, "label: True is not text"),
        ("label", None, "label: None is not text"),
        ("inner", {"sigma": True}, "inner.sigma: True is not a number"),
        ("inner", {"sigma": "x"}, "inner.sigma: 'x' is not a number"),
        ("inner", {"sigma": 0}, "inner.sigma: 0 m must be a finite number above zero"),
        ("inner", {"sigma": float("inf")}, "inner.sigma: inf m must be a finite number"),
        ("inner", {"delay": -1}, "inner.delay: -1 s must be a finite number, zero or above"),
        ("inner", {"on": "true"}, "inner.on: 'true' is not true or false"),
        ("inner", {"on": 1}, "inner.on: 1 is not true or false"),
        ("inner", 3, "inner: 3 is one value where keys are expected; use inner.<key>=..."),
        ("inner", {"sigm": 3}, "inner.sigm: there is no such key; did you mean inner.sigma?"),
        ("kind", "c", "kind: 'c' is none of a, b"),
        ("kinds", ["a", "c"], "kinds[1]: 'c' is none of a, b"),
        ("count", 0, "count: 0 must be at least 1 steps"),
        ("count", 10, "count: 10 is more than 9; lower it"),
        ("ratio", 1, "ratio: 1 must be below 1"),
        ("pair", [1.0], "pair: [1.0] must be two numbers"),
        ("pair", [1.0, 0.0],
         "pair[1]: 0 must be a finite number above zero; use two numbers"),
        ("seed", -1, "seed: -1 is negative; use an integer >= 0"),
        ("study", {}, "study: {} is not text"),
    ],
)  # fmt: skip
def test_what_is_wrong_is_one_line(key: str, value: object, message: str) -> None:
    with pytest.raises(InputError) as caught:
        make(**{key: value})
    assert str(caught.value) == message


def test_bounds_on_a_list_are_refused_where_the_section_is_made() -> None:
    with pytest.raises(TypeError, match=r"^Grid\.level: the bounds of a list's numbers .* Axis\["):

        class Grid(Section):
            """Its author means each number of the list."""

            level: Axis[float] = key("a level", gt=0.0)


def test_a_study_with_one_engine_has_no_other() -> None:
    with pytest.raises(InputError, match=r"^engine: 'refrence' is not known; .* one engine"):
        checked(Model, {"study": "x", "engine": "refrence"})


def test_texts_from_numbers_and_numbers_from_texts() -> None:
    config = make(label=3, inner={"sigma": "0.5"})
    assert (config.label, config.inner.sigma) == ("3", 0.5)


def test_an_unknown_key_is_told_before_wrong_values() -> None:
    with pytest.raises(InputError, match=r"^labl: there is no such key; did you mean label\?$"):
        make(labl="x", count="x")


def test_a_key_that_no_file_sets_is_told_with_how_to_set_it() -> None:
    told = explain_unknown_key("inner.sigma", ["inner.sigma"])
    assert told == "inner.sigma: no YAML file sets this key yet; use +inner.sigma=..."


def test_a_missing_key_is_told() -> None:
    with pytest.raises(InputError, match=r"^study: this key has no value; give it one$"):
        typed(Model, {})


def test_sections_are_frozen_and_copied() -> None:
    config = make()
    with pytest.raises(ValidationError):
        config.inner.sigma = 3.0
    assert changed(config, count=77).count == 77  # whoever calls it answers for bounds
    assert with_values(config, {"inner.sigma": 3}).inner.sigma == 3.0
    assert with_values(config, {"section.sigma": 3}).section == Inner(sigma=3.0)
    assert config == make()
    for wrong in ({"inner.sgma": 1.0}, {"nothing.there": 1}, {"inner.sigma": "x"}):
        with pytest.raises(InputError, match=rf"^{next(iter(wrong)).split('.')[0]}"):
            with_values(config, wrong)


def test_config_yaml_is_read_back(tmp_path) -> None:
    config = make(pair=[0.1 + 0.2, 1e-7], label="12", section={})
    path = tmp_path / "config.yaml"
    path.write_text(dump(config))
    assert checked(Model, read_stored(path)[0]) == config
    path.write_text(path.read_text().replace("count: 3", "count: 0"))
    with pytest.raises(InputError, match=r"^count: 0 must be at least 1"):
        checked(Model, read_stored(path)[0])
    deep = "a: " + "[" * 50 + "]" * 50
    for text in ("[1]", "{bad", "just text", "a: ${b}", "a: &x 1\nb: *x", deep):
        path.write_text(text)
        with pytest.raises(InputError, match=r".") as caught:
            checked(Model, read_stored(path)[0])
        assert "\n" not in str(caught.value)


def test_what_spans_keys_is_checked_after_typing() -> None:
    with pytest.raises(InputError, match=r"^config_version: 9 is not known"):
        checked(Model, {"study": "x", "config_version": 9})


def test_the_unit_of_a_key_is_found_by_its_dotted_name() -> None:
    class Sensor(Section):
        rate: float = key("samples", unit="Hz")
        name: str = key("a name")

    class Model(Config):
        sensor: Sensor = key("one sensor")

    assert unit_of(Model, "sensor.rate") == "Hz"
    for without in ("sensor.name", "sensor", "sensor.rate.more"):
        assert unit_of(Model, without) == ""
