"""Computes names from hashes: the key of a block (unit of work), a run's hash, a run's folder."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from hashlib import blake2b
from pathlib import Path

from owtsweep.config import Config, as_mapping, require
from owtsweep.errors import InputError
from owtsweep.sweep.study import Block, Study

#: Bytes of a block's key: 128 bits, so two blocks never get the same key by chance.
KEY_BYTES = 16
#: Bytes of a run's hash: few, so that it can be typed.
HASH_BYTES = 5
#: Most bytes of a folder's name: every file system takes as many.
LONGEST_NAME = 255
#: Top-level keys of a configuration that may change without making another run. They say what is
#: swept over, how the sweep is computed, where results are stored, and what `tune` searches.
NOT_IDENTIFYING = frozenset(
    {"grid", "over", "schemes", "baselines", "tune", "compute", "results", "name"}
)

#: Top-level keys of a configuration on which no table and no figure depends.
NOT_ASKED = frozenset({"tune", "compute", "results", "name"})


def list_versions(study: Study) -> dict[str, str | int]:
    """Return a study's name and versions, under study, schema_version and numerics_version."""
    return {
        "study": study.name,
        "schema_version": study.schema_version,
        "numerics_version": study.numerics_version,
    }


def block_key(study: Study, block: Block) -> str:
    """Return the key of a block (unit of work): 32 hexadecimal digits.

    The key names the file that stores the block's rows. The key depends only on the study's name,
    `schema_version` and `numerics_version`, and on the block's content. So the content must hold
    everything on which the rows depend, including the seed.

    Raises InputError if the content holds a value without an exact JSON form (NaN, an array, an
        object).
    """
    identity = {**list_versions(study), "content": block.content}
    return _digest(identity, KEY_BYTES, what=f"block {block.label}")


def hash_text(text: str) -> str:
    """Return a short hash of a text: 10 hexadecimal digits."""
    # the name of a folder need not be UTF-8
    return blake2b(text.encode(errors="surrogateescape"), digest_size=HASH_BYTES).hexdigest()


def run_hash(config: Config) -> str:
    """Return the hash that identifies a run: 10 hexadecimal digits.

    The hash covers the configuration without the keys of `NOT_IDENTIFYING` and of `Config.swept`.
    So a larger grid, further worlds, another scheme, more workers or another folder do not
    change the hash.
    """
    identity = {key: item for key, item in as_mapping(config).items() if key not in NOT_IDENTIFYING}
    for path in config.swept:
        *sections, name = path.split(".")
        inner = identity
        for section in sections:
            inner = inner.get(section, {})
        inner.pop(name, None)
    return _digest(identity, HASH_BYTES, what="config")


def question_hash(config: Config) -> str:
    """Return the hash that identifies what a sweep was asked: 10 hexadecimal digits.

    The hash covers the whole configuration with grid and schemes, but without the keys
    of `NOT_ASKED` and the time after which a sweep stops.
    """
    identity = {key: item for key, item in as_mapping(config).items() if key not in NOT_ASKED}
    if config.records is not None:
        identity["grid"].pop("budget")
    return _digest(identity, HASH_BYTES, what="config")


def run_folder(config: Config) -> Path:
    """Return the folder of a run: `<results>/<name>`, or `<results>/<experiment>-<hash>`.

    The form with the hash is used if the key `name` of the configuration is null. A
    study may put more between the experiment and the hash (`Config.start_of_folder`).

    Raises InputError if `experiment` cannot be part of a folder's name, or the name is too long.
    """
    key, name = "name", config.name
    if name is None:
        require(
            re.fullmatch(r"[\w.+=,-]+", config.experiment) is not None,
            f"experiment: {config.experiment!r} cannot be part of a folder's name; "
            "use letters, digits, . _ - + = ,",
        )
        key, name = "experiment", f"{config.start_of_folder()}-{run_hash(config)}"
    require(
        len(name.encode()) <= LONGEST_NAME,
        f"{key}: the run folder's name would have {len(name)} characters; use a shorter one, of at "
        f"most {LONGEST_NAME}",
    )
    return Path(config.results) / name


def _digest(identity: Mapping[str, object], size: int, *, what: str) -> str:
    try:
        # Python writes a float as the shortest text that reads back as the same float.
        text = json.dumps(
            identity, sort_keys=True, separators=(",", ":"), allow_nan=False, default=_as_dict
        )
    except (TypeError, ValueError) as error:
        raise InputError(
            f"{what}: its content cannot be hashed ({error}); use finite numbers, text and lists"
        ) from error
    return blake2b(text.encode(), digest_size=size).hexdigest()


def _as_dict(value: object) -> dict[object, object]:
    if isinstance(value, Mapping):
        return dict(value)
    raise TypeError(f"{type(value).__name__} has no exact JSON form")
