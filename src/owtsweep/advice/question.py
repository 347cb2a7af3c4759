"""The question of an advice: a configuration of one cell, composed from overrides."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

from owtsweep.config import Config, as_mapping, get_key, require
from owtsweep.config.typed import changed, value_at
from owtsweep.errors import InputError
from owtsweep.results.conditions import Condition, Value, show_value
from owtsweep.studies import compose, get_study, locate
from owtsweep.sweep.study import Study

#: The sections of a configuration that hold the axes of a grid, by study and world.
SECTIONS = ("grid", "motion")
#: The folder, in that of the results, that holds the runs of all advice.
FOLDER = "advice"


class Question(NamedTuple):
    """A case about which advice is asked.

    given: the overrides as the user gave them.
    words: the overrides, with each axis as a key of its section.
    config: the configuration, whose grid has one cell, and which has one tuning.
    cell: Condition -> value, of the axes of the study's map.
    config_dir: a folder with further config groups; None without one.
    """

    given: Sequence[str]
    words: list[str]
    config: Config
    study: Study
    cell: Mapping[Condition, Value]
    config_dir: str | None = None

    def change(self, *words: str) -> Config:
        """Return the configuration with further overrides, each in place of an earlier one."""
        given = {get_key(word) for word in words}
        kept = [word for word in self.words if get_key(word) not in given]
        return _keep_apart(compose([*kept, *words], self.config_dir))

    def tell(self) -> str:
        """Return in words what is asked: study, cell, and the overrides that are neither.

        E.g. "hub, natural period 3.2 s, amplitude 0.5 m, sensors.gnss.rate=10".
        """
        values = [f"{c.word} {c.show(value)}" for c, value in self.cell.items()]
        said = {"study", *(f"{s}.{c.name}" for c in self.cell for s in SECTIONS)}
        others = [
            given
            for given, word in zip(self.given, self.words, strict=False)
            if get_key(word) not in said
        ]
        return ", ".join([self.study.name, *values, *others])


def ask(overrides: Sequence[str], config_dir: str | None = None) -> Question:
    """Compose the configuration of one cell.

    overrides: Hydra's, where an axis may be given without its section: `natural_period=3.2` is
        `grid.natural_period=[3.2]`.
    Raises InputError if an override is wrong, an axis of the map has several values, or several
        tunings are asked for.
    """
    words = _name_sections(overrides, config_dir)
    config = compose(words, config_dir)
    study = get_study(config.study)
    config.require_one_tuning()
    require(
        config.name is None,
        "name: `advise` names its folders by their questions; leave out name, or choose another "
        "place by results=FOLDER",
    )
    require(
        config.over is None,
        "over: `advise` asks about the study's worlds by itself; leave out over, or use `sweep`",
    )
    require(
        study.engine(config).samples,
        f"engine: advice rests on records, and engine={config.engine} has none; leave out engine",
    )
    cell = _find_cell(study, config)
    require(
        len(cell) > 0,
        f"study: {study.name!r} has no case of its own; use `sweep study={study.name}`",
    )
    if study.advised_schemes and not any(get_key(word) == "schemes" for word in words):
        names = [*getattr(config, "schemes", ()), *study.advised_schemes]
        words = [*words, f"schemes=[{','.join(dict.fromkeys(map(str, names)))}]"]
        config = compose(words, config_dir)
    return Question(overrides, words, _keep_apart(config), study, cell, config_dir)


def _name_sections(overrides: Sequence[str], config_dir: str | None) -> list[str]:
    """Return the overrides, with each axis that stands without its section as a key of it.

    A word without a dot is an axis if the configuration has no such key or group at its top, and
    one of `SECTIONS` has it. What is neither is left to be refused like any unknown key.
    """
    tree = locate(overrides).tree
    top = {"study", *tree.model.model_fields, *tree.groups()}
    short = {word for word in overrides if "." not in get_key(word) and get_key(word) not in top}
    if not short:
        return [*overrides]
    plain = as_mapping(compose([word for word in overrides if word not in short], config_dir))
    words = []
    for word in overrides:
        key, _, value = word.partition("=")
        section = next((s for s in SECTIONS if key in (plain.get(s) or {})), None)
        if word in short and section is not None:
            listed = value if value.startswith("[") else f"[{value}]"
            word = f"{section}.{key}={listed}"
        words.append(word)
    return words


def _find_cell(study: Study, config: Config) -> dict[Condition, Value]:
    """Return condition -> value; raise InputError if an axis has several values."""
    plain, cell, several = as_mapping(config), {}, []
    for condition in study.conditions(config):
        found = (value_at(plain, f"{section}.{condition.name}") for section in SECTIONS)
        values = next((each for each in found if isinstance(each, list) and each), [])
        if len(values) == 1:
            cell[condition] = values[0]
        elif values:  # without any, nothing is varied along this axis
            several.append((condition, values))
    if several:
        names = " and ".join(condition.name for condition, _ in several)
        ends = ", ".join(f"{c.word} {_tell_ends(c, values)}" for c, values in several)
        example = " ".join(
            f"{c.name}={show_value(values[len(values) // 2])}" for c, values in several
        )
        raise InputError(
            f"{names}: advice is for one case, so give one value each, e.g. `{example}`; "
            f"the study's own: {ends}"
        )
    return cell


def _tell_ends(condition: Condition, values: Sequence[Value]) -> str:
    return f"{show_value(values[0])} to {condition.show(values[-1])}"


def _keep_apart(config: Config) -> Config:
    """Return the configuration with its run in a folder for advice, which shows no map."""
    return changed(config, results=str(Path(config.results) / FOLDER))
