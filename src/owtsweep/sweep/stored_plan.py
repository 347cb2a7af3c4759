"""plan.json: the plan of a run, stored beside its configuration.

Who reads a run finds its cases by it, without planning anew. So nothing that the configuration
names is imported, and a run of an older version can still be read.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Mapping
from hashlib import blake2b
from pathlib import Path
from typing import Any

from owtsweep.config import Config
from owtsweep.errors import InputError, printable
from owtsweep.io.reading import read_json
from owtsweep.sweep.plan import Plan
from owtsweep.sweep.study import Block

NAME = "plan.json"
#: Most bytes of a plan: that of a hundred million cases.
MOST_BYTES = 2_000_000_000
_KEY = re.compile(r"[0-9a-f]{32}")


def dump_plan(plan: Plan, config: Config, text: str) -> str:
    """The content of plan.json.

    Parameters
    ----------
    plan
        The blocks.
    config
        The configuration; it says what readers must know of the user's own code.
    text
        The content of config.yaml, to which the plan belongs.
    """
    blocks = [[key, block.label, block.cases, block.cases_per_row] for key, block in plan.items()]
    return json.dumps(
        {"config_digest": digest(text), "code": config.describe_code(), "blocks": blocks}
    )


def digest(text: str) -> str:
    """The digest of a configuration's text."""
    return blake2b(text.encode(), digest_size=16).hexdigest()


def read_stored_plan(folder: Path, text: str) -> Mapping[str, Any] | None:
    """The content of plan.json, or None if there is none for this text of config.yaml.

    Raises
    ------
    InputError
        If the file is no plan.
    """
    path = folder / NAME
    if not os.path.lexists(path):
        return None
    stored = read_json(path, MOST_BYTES)
    if not isinstance(stored, dict):
        raise _refuse(path)
    return stored if stored.get("config_digest") == digest(text) else None


def read_blocks(folder: Path, stored: Mapping[str, Any]) -> Plan:
    """The blocks of a stored plan; they have no content, so they can be read but not computed.

    Raises
    ------
    InputError
        If a block is not what `dump_plan` writes.
    """
    blocks = stored.get("blocks")
    if not isinstance(blocks, list) or not blocks:
        raise _refuse(folder / NAME)
    plan: Plan = {}
    for entry in blocks:
        match entry:
            case [str(key), str(label), int(cases), int(per_row)] if (
                _KEY.fullmatch(key) and cases > 0 and per_row > 0
            ):
                plan[key] = Block("", printable(label), {}, cases, per_row)
            case _:
                raise _refuse(folder / NAME)
    return plan


def _refuse(path: Path) -> InputError:
    return InputError(f"{path}: this is no plan of a run; run its sweep again")
