"""Plans the work of a sweep: the blocks (units of work) by key; writes and reads plan.json.

plan.json stands beside a run's configuration. With it the cases of a run are found without planning
anew. So no code that the configuration names is imported. The file also holds the versions of what
made the run; a run of other versions is refused.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from dataclasses import replace
from hashlib import blake2b
from pathlib import Path
from typing import TYPE_CHECKING, Any

from owtsweep.config import Config, require
from owtsweep.config.over import NOMINAL, name_worlds
from owtsweep.errors import InputError, printable
from owtsweep.io.reading import read_json
from owtsweep.sweep.keys import block_key, list_versions
from owtsweep.sweep.study import Block, Study

if TYPE_CHECKING:
    import pandas as pd

#: Blocks by key, in the study's order.
Plan = dict[str, Block]


PLAN_FILE = "plan.json"
#: Most bytes of plan.json: enough for a hundred million cases.
MOST_BYTES = 2_000_000_000
_KEY = re.compile(r"[0-9a-f]{32}")


def make_plan(study: Study, config: Config) -> Plan:
    """Return all blocks of a configuration by key; of blocks with equal content, keep the first.

    With several tunings, the blocks of each tuning are planned. A block that does not depend on the
    tuning belongs to all of them.

    Raises InputError if the configuration has no blocks, or the study refuses the configuration.
    """
    parts = config.by_tuning().items()
    blocks = {tuning: study.engine(part).plan(part) for tuning, part in parts}
    plan = _join_tunings(study, {}, blocks)
    require(len(plan) > 0, "grid: it holds no case; give every list of the grid a value")
    return plan


def plan_look(
    study: Study, config: Config, plan: Plan, rows: Mapping[str, pd.DataFrame]
) -> tuple[Plan, str]:
    """Return a plan with the blocks of the next look, and what the last one has found, in words.

    It is the same plan if all cells are decided, and the text is "".

    plan: the blocks of all looks before.
    rows: Tuning -> rows of these blocks.
    """
    blocks, found = {}, []
    for tuning, part in config.by_tuning().items():
        look = study.engine(part).plan_look(part, rows[tuning]) if tuning in rows else None
        if look is not None:
            blocks[tuning] = look.blocks
            found.append(f"{tuning}: {look.found}" if tuning else look.found)
    return _join_tunings(study, plan, blocks), "; ".join(found)


def _join_tunings(study: Study, plan: Plan, blocks: Mapping[str, Sequence[Block]]) -> Plan:
    """Return a plan with the blocks of each tuning added, under their keys."""
    joined = dict(plan)
    for tuning, of_tuning in blocks.items():
        for block in of_tuning:
            key = block_key(study, block)
            joined.setdefault(key, block)
            if tuning and tuning not in joined[key].tunings:
                joined[key] = replace(joined[key], tunings=(*joined[key].tunings, tuning))
            if not {*block.worlds} <= {*joined[key].worlds}:
                worlds = (*joined[key].worlds, *block.worlds)
                joined[key] = replace(joined[key], worlds=worlds)
    for key, block in joined.items():
        if key not in plan and len(block.tunings) == 1:
            joined[key] = replace(block, label=f"{block.label}, {block.tunings[0]}")
    return joined


def make_tasks(plan: Mapping[str, Block]) -> list[Plan]:
    """Group the blocks (units of work) of a plan into tasks; a task is key -> block.

    There is one task per `Block.group`. Blocks of one group share expensive inputs, so the blocks
    should run together.
    """
    groups: dict[str, Plan] = {}
    for key, block in plan.items():
        groups.setdefault(block.group, {})[key] = block
    return list(groups.values())


def count_cases(plan: Mapping[str, Block]) -> int:
    """Return the number of cases in all blocks (units of work) of a plan."""
    return sum(block.cases for block in plan.values())


def dump_plan(plan: Plan, study: Study, config: Config, text: str) -> str:
    """Return the content of plan.json as text.

    plan: the blocks (units of work) of the run by key.
    study, config: the run's study, which names its versions and says what is stored of a user's
        code, and its configuration.
    text: the content of config.yaml, to which the plan belongs.
    """
    several = "" not in config.by_tuning() or config.over is not None
    blocks = [
        [
            key, block.label, block.cases, block.cases_per_row,
            *([block.tunings or block.worlds] * several),
        ]
        for key, block in plan.items()
    ]  # fmt: skip
    head = {"versions": list_versions(study), "config_digest": digest(text)}
    return json.dumps({**head, "code": study.describe_code(config), "blocks": blocks})


def digest(text: str) -> str:
    """Return the digest of a text, the content of config.yaml: 32 hexadecimal digits."""
    return blake2b(text.encode(), digest_size=16).hexdigest()


def read_stored_plan(study: Study, folder: Path, text: str) -> Mapping[str, object]:
    """Read plan.json in a run folder; `text` is the content of the folder's config.yaml.

    Raises InputError if plan.json cannot be read or is not a JSON mapping, the run is of other
        versions than those of `study`, or config.yaml has been changed since plan.json was written.
    """
    path = folder / PLAN_FILE
    stored = read_json(path, MOST_BYTES) if os.path.lexists(path) else {}
    if not isinstance(stored, dict):
        raise _refuse(path)
    require(
        stored.get("versions") == list_versions(study),
        f"{folder}: this run was made by another version of owtsweep; run its sweep again",
    )
    require(
        stored.get("config_digest") == digest(text),
        f"{folder}: its config.yaml was changed since {PLAN_FILE} was written; run its sweep again",
    )
    return stored


def is_of_other_version(study: Study, folder: Path) -> bool:
    """Return whether a folder holds a run of other versions than those of `study`.

    A run without plan.json is one. A damaged plan.json and a run of another study are not.
    """
    path = folder / PLAN_FILE
    if not os.path.lexists(path):
        return os.path.lexists(folder / "config.yaml")
    try:
        stored = read_json(path, MOST_BYTES)
    except InputError:
        return False
    match stored:
        case {"versions": {"study": str(name)}} if name != study.name:
            return False
        case dict():
            return stored.get("versions") != list_versions(study)
    return False


def read_blocks(path: Path, stored: object) -> Iterator[tuple[Block, str, list[Any]]]:
    """Yield each block of a stored plan, its key, and the names of its tunings or worlds.

    These blocks have no content, so their rows can be read, but not computed. `path` is that of
    plan.json, and `stored` what it holds.

    Raises InputError if there are no blocks, or a block is not of the form that `dump_plan` writes.
    """
    match stored:
        case {"blocks": [*entries]} if entries:
            pass
        case _:
            raise _refuse(path)
    for entry in entries:
        match entry:
            case [str(key), str(label), int(cases), int(per_row), *names] if (
                _KEY.fullmatch(key) and cases > 0 and per_row > 0
            ):
                yield Block("", printable(label), {}, cases, per_row), key, names
            case _:
                raise _refuse(path)


def read_plan(folder: Path, stored: object, config: Config) -> Plan:
    """Return the blocks of a stored plan by key.

    folder: the run folder, for messages.
    stored: What `read_stored_plan` returns.
    config: the configuration of the run. It has several tunings, several worlds, or one of both.
    Raises InputError as `read_blocks`, or if a block names no tuning or world of the run.
    """
    plan: Plan = {}
    worlds = [] if config.over is None else [NOMINAL, *name_worlds(config.over)]
    known = worlds or [name for name in config.by_tuning() if name]
    for block, key, names in read_blocks(folder / PLAN_FILE, stored):
        if not _fit(names, known):
            raise _refuse(folder / PLAN_FILE)
        of = tuple(names[0]) if names else ()
        plan[key] = replace(block, worlds=of) if worlds else replace(block, tunings=of)
    return plan


def _fit(names: list[Any], known: Collection[str]) -> bool:
    """Return whether a block's entry names tunings or worlds of the run, none if it has one."""
    if not known:
        return not names
    listed = names[0] if len(names) == 1 and isinstance(names[0], list) else []
    return bool(listed) and all(name in known for name in listed)


def _refuse(path: Path) -> InputError:
    return InputError(f"{path}: this is no plan of a run; run its sweep again")
