"""Writes and reads plan.json: the plan of a run, stored beside its configuration.

The plan is the list of the run's blocks (units of work). With plan.json, the cases of a run are
found without planning anew. So no code that the configuration names is imported, and a run of an
older version of owtsweep can still be read.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Collection, Mapping
from hashlib import blake2b
from pathlib import Path
from typing import Any

from owtsweep.config import Config
from owtsweep.errors import InputError, printable
from owtsweep.io.reading import read_json
from owtsweep.sweep.plan import Plan
from owtsweep.sweep.study import Block, Study

NAME = "plan.json"
#: Most bytes of plan.json: enough for a hundred million cases.
MOST_BYTES = 2_000_000_000
_KEY = re.compile(r"[0-9a-f]{32}")


def dump_plan(plan: Plan, study: Study, config: Config, text: str) -> str:
    """Return the content of plan.json as text.

    Parameters
    ----------
    plan
        The blocks (units of work) of the run by key.
    study, config
        The run's study, which says what is stored of a user's code, and its configuration.
    text
        The content of config.yaml, to which the plan belongs.
    """
    several = "" not in config.by_tuning()
    blocks = [
        [key, block.label, block.cases, block.cases_per_row, *([block.tunings] * several)]
        for key, block in plan.items()
    ]
    return json.dumps(
        {"config_digest": digest(text), "code": study.describe_code(config), "blocks": blocks}
    )


def digest(text: str) -> str:
    """Return the digest of a text, the content of config.yaml: 32 hexadecimal digits."""
    return blake2b(text.encode(), digest_size=16).hexdigest()


def read_stored_plan(folder: Path, text: str) -> Mapping[str, Any] | None:
    """Read plan.json in a run folder; `text` is the content of the folder's config.yaml.

    Return None if there is no plan.json, or if config.yaml has been changed since plan.json was
    written.

    Raises
    ------
    InputError
        If plan.json cannot be read, or is not a JSON mapping.
    """
    path = folder / NAME
    if not os.path.lexists(path):
        return None
    stored = read_json(path, MOST_BYTES)
    if not isinstance(stored, dict):
        raise _refuse(path)
    return stored if stored.get("config_digest") == digest(text) else None


def read_blocks(folder: Path, stored: Mapping[str, Any], tunings: Collection[str]) -> Plan:
    """Return the blocks of a stored plan by key.

    These blocks have no content, so their rows can be read, but not computed.

    Parameters
    ----------
    folder
        The run folder, for messages.
    stored
        What `read_stored_plan` returns.
    tunings
        The tunings of the run if it has several, otherwise empty.

    Raises
    ------
    InputError
        If there are no blocks, or a block is not of the form that `dump_plan` writes.
    """
    blocks = stored.get("blocks")
    if not isinstance(blocks, list) or not blocks:
        raise _refuse(folder / NAME)
    plan: Plan = {}
    for entry in blocks:
        match entry:
            case [str(key), str(label), int(cases), int(per_row), *names] if (
                _KEY.fullmatch(key) and cases > 0 and per_row > 0 and _fit(names, tunings)
            ):
                of = tuple(names[0]) if names else ()
                plan[key] = Block("", printable(label), {}, cases, per_row, tunings=of)
            case _:
                raise _refuse(folder / NAME)
    return plan


def _fit(names: list[Any], tunings: Collection[str]) -> bool:
    """Return whether a block's entry names tunings of the run, or none in a run of one tuning."""
    if not tunings:
        return not names
    listed = names[0] if len(names) == 1 and isinstance(names[0], list) else []
    return bool(listed) and all(name in tunings for name in listed)


def _refuse(path: Path) -> InputError:
    return InputError(f"{path}: this is no plan of a run; run its sweep again")
