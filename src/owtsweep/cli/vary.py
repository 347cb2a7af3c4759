"""The command `vary`: compute the schemes' errors over the values of one key; draw one figure."""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from typing import Literal

from owtsweep.cli.combinations import Combination, combine, count_runs, list_swept, parse
from owtsweep.cli.program import DONE
from owtsweep.cli.running import (
    describe_cost,
    name_folder,
    require_serving,
    show_answer,
    tell_dry_run,
)
from owtsweep.config import Config, as_mapping, compose_plain, dump, dump_with_units, get_key
from owtsweep.config.grid import Records
from owtsweep.config.section import unit_of
from owtsweep.config.tuned import GROUP
from owtsweep.config.typed import value_at
from owtsweep.errors import printable, require
from owtsweep.io.files import refuse_in_one_line, write_atomically
from owtsweep.results.conditions import Condition, Value
from owtsweep.studies import compose, locate
from owtsweep.studies.registry import DEFAULT
from owtsweep.sweep.keys import NOT_IDENTIFYING, question_hash
from owtsweep.sweep.study import blame

EXAMPLE = "KEY=1,2,5"
#: Most values of a key: more can be told apart neither in the table nor in the figure.
MOST_VALUES = 100
#: From this ratio of the largest to the smallest value on, the figure's axis is logarithmic.
WIDE = 4.0
#: The configurations of all values, one YAML document each.
CONFIGURATIONS = "configurations.yaml"


def run(options: argparse.Namespace, argv: Sequence[str]) -> int:
    """Compute the errors, write table and figure, print the answer, and return 0.

    With `--cfg`, print the configuration of each value and compute nothing; with `--dry-run`, print
    what would be computed.

    Raises InputError if not exactly one override has several values, the study cannot vary a key,
        or a configuration is refused.
    """
    from owtsweep.io.terminal import show_steps

    key, configs = compose_each(options.overrides, options.config_dir)
    if options.cfg:
        print("---\n".join(dump_with_units(config) for config in configs.values()), end="")
        return DONE
    one = next(iter(configs.values()))
    study = require_serving("vary", one.study)
    along = Condition("value", key, _find_unit(one, key), _choose_scale(list(configs)))
    with blame(study):
        study.check_vary(along, configs)
    query = [key, *(f"{value} {question_hash(config)}" for value, config in configs.items())]
    folder = name_folder("vary", one, "\n".join(query))
    if options.dry_run:
        with blame(study):
            cost = describe_cost(study.predict_vary(configs))
        values = f"values  {len(configs)} of {key}"
        return tell_dry_run([f"folder  {printable(str(folder))}/", values, *cost])
    with blame(study):
        with show_steps():
            varied = study.vary(along, configs)
        with refuse_in_one_line(folder):
            files = varied.write(folder, {"vary": folder.name, "key": key})
            text = "---\n".join(dump(config) for config in configs.values())
            write_atomically(folder / CONFIGURATIONS, text)
        answer = varied.answer()
    show_answer(answer)
    print(f"{len(files) + 1} files: {printable(str(folder))}/")
    return DONE


def compose_each(
    overrides: Sequence[str], config_dir: str | None = None
) -> tuple[str, dict[Value, Config]]:
    """Compose a configuration for each value of the one key that has several.

    Return the key, and value -> configuration. The values are numbers in increasing order if the
    key holds numbers; otherwise texts as typed.

    Raises InputError if not exactly one override has several values, the study cannot vary a key,
        or a configuration is refused.
    """
    from hydra.core.override_parser.types import ChoiceSweep, RangeSweep

    located = locate(overrides)
    for word in overrides:
        require(
            not word.lstrip("+~").startswith("hydra"),
            f"{word}: Hydra's own settings work with `sweep --multirun` only",
        )
    parsed = parse(overrides, located.tree)
    swept = [key.lstrip("+") for key in list_swept(parsed)]
    require(
        bool(swept),
        f"overrides: none has several values; give one key its values, e.g. {EXAMPLE}, or ask "
        "`advise` about one",
    )
    key = swept[0]
    require(
        len(swept) == 1,
        f"{' and '.join(swept)}: `vary` takes several values of one key only; give each other key "
        "one value",
    )
    study = require_serving("vary", located.study or DEFAULT)
    section, _, axis = key.partition(".")
    on_axis = section == "grid" and axis not in Records.model_fields
    require(
        on_axis or section not in (*NOT_IDENTIFYING, "study"),
        f"{key}: `vary` compares sensors, tunings and truths; give this key one value",
    )
    require(
        all(
            isinstance(o.value(), ChoiceSweep | RangeSweep) for o in parsed if o.is_sweep_override()
        ),
        f"{key}: list its values, e.g. {EXAMPLE}, or give a range, e.g. {key}=range(1,5)",
    )
    number = count_runs(parsed)
    require(
        number <= MOST_VALUES,
        f"{key}: {number:.6g} values are too many; give at most {MOST_VALUES}",
    )
    listed = combine(parsed, located.tree)
    if on_axis:  # an axis takes a list, here of one value
        listed = [_put_into_list(key, one) for one in listed]
    first = locate(listed[0].overrides)
    plain = compose_plain(first.tree, first.overrides, config_dir)
    start = _leave_out_given(study.list_vary_defaults(plain), overrides)
    composed = [
        (next(iter(values.values())), compose([*start, *words], config_dir))
        for words, values in listed
    ]
    for _, config in composed:
        require_serving("vary", config.study)  # an experiment may name another study
        require(
            "" in config.by_tuning(),
            f"{GROUP}: `vary` takes one tuning for each value; to compare tunings, give "
            f"{GROUP}=paper,matched without brackets",
        )
    return key, _by_value(key, composed)


def _put_into_list(key: str, one: Combination) -> Combination:
    """Return a combination whose value of an axis stands in brackets: grid.noise=3 as [3]."""
    value = one.values[key]
    if value.startswith("["):
        return one
    words = [
        f"{word.partition('=')[0]}=[{value}]" if get_key(word) == key else word
        for word in one.overrides
    ]
    return Combination(words, one.values)


def _leave_out_given(defaults: Sequence[str], overrides: Sequence[str]) -> list[str]:
    """Return the overrides of `defaults` whose key, or a section of it, is in no override."""
    given = tuple(f"{get_key(word)}." for word in overrides)
    return [word for word in defaults if not f"{get_key(word)}.".startswith(given)]


def _by_value(key: str, composed: Sequence[tuple[str, Config]]) -> dict[Value, Config]:
    """Return value -> configuration, from each value as typed with its configuration."""
    numbers = [_read_number(config, key) for _, config in composed]
    found: dict[Value, Config] = {}
    for number, (text, config) in zip(numbers, composed, strict=True):
        value: Value = text if None in numbers or number is None else number
        require(value not in found, f"{key}: {text} stands there twice; give each value once")
        found[value] = config
    require(len(found) > 1, f"{key}: it has one value only; give several, e.g. {EXAMPLE}")
    return found if None in numbers else dict(sorted(found.items()))


def _read_number(config: Config, key: str) -> float | None:
    """Return the number that a configuration holds at a key; None if the key holds something else.

    The key of a config group, e.g. `sensors`, holds a section.
    """
    value = value_at(as_mapping(config), key)
    if isinstance(value, list) and len(value) == 1:  # an axis
        (value,) = value
    if isinstance(value, bool) or not isinstance(value, int | float):
        return None
    return float(value)


def _find_unit(config: Config, key: str) -> str:
    """Return the unit of a key as it is drawn, e.g. "m/s²" for "m/s^2"; "" if it has none."""
    unit = unit_of(type(config), key)
    return unit.replace("^2", "²").replace("^3", "³").replace("sqrt(s)", "√s")


def _choose_scale(values: Sequence[Value]) -> Literal["linear", "log"]:
    numbers = [value for value in values if not isinstance(value, str)]
    wide = bool(numbers) and min(numbers) > 0.0 and max(numbers) >= WIDE * min(numbers)
    return "log" if wide else "linear"
