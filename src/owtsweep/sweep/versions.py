"""Compares versions: would this version of owtsweep compute the rows that are stored?"""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from owtsweep._version import __version__
from owtsweep.io.reading import require_regular
from owtsweep.sweep.keys import block_key
from owtsweep.sweep.plan import Plan
from owtsweep.sweep.shard import PREFIX
from owtsweep.sweep.store import Store
from owtsweep.sweep.study import Study

#: The number of shards outside the plan whose versions are read: enough to find all versions.
SAMPLE = 64
KINDS = ("schema_version", "numerics_version")


def shard_metadata(study: Study) -> dict[str, str | int]:
    """Return a study's name and versions, under study, schema_version and numerics_version."""
    return {
        "study": study.name,
        "schema_version": study.schema_version,
        "numerics_version": study.numerics_version,
    }


def all_versions(study: Study) -> dict[str, str]:
    """Return a study's name and versions, and the version of owtsweep, all as text.

    The keys are study, schema_version, numerics_version and owtsweep_version.
    """
    entries = {**shard_metadata(study), "owtsweep_version": __version__}
    return {name: str(value) for name, value in entries.items()}


def tell_other_versions(study: Study, expected: Mapping[str, str]) -> str:
    """Return in one line how the versions of a worker differ from `expected`; "" if they agree.

    This function runs on the worker. `expected` is what `all_versions` returns in the process that
    started the sweep.
    """
    ours = all_versions(study)
    differing = [name for name, value in expected.items() if ours.get(name, value) != value]
    if not differing:
        return ""
    told = ", ".join(f"{name} {ours[name]} instead of {expected[name]}" for name in differing)
    return f"the worker has {told}; give it the coordinator's version of owtsweep"


def count_outdated(study: Study, store: Store, plan: Plan, missing: Plan) -> dict[str, int]:
    """Count the cases that must be computed anew because another version of the study stored them.

    Return change of version -> number of cases; a change reads like "schema version 1 -> 2".

    A block is the unit of work. Its rows are stored in a file, the shard, which is named by the
    block's key. Versions are part of the key, so the plan has no key for shards of other versions.
    A sample of these shards shows which versions exist. Then the shards of the missing blocks are
    looked up under the keys that the blocks would have in those versions. `missing` holds the
    blocks of `plan` that are not done.
    """
    if not missing:
        return {}
    present = {path.name for path in store.cases.glob("part-*.parquet")}
    foreign = sorted(present - {store.path(key).name for key in plan})
    ours = (study.schema_version, study.numerics_version)
    # Keys are hashes, so evenly spaced names are a random sample.
    sample = foreign[:: max(1, len(foreign) // SAMPLE)]
    stored = {_read_versions(store.cases / name, ours) for name in sample}
    changes: dict[str, int] = {}
    for theirs in sorted(stored - {ours}):
        named = dict(zip(KINDS, theirs, strict=True))
        # A stand-in for the study: a block's key depends on these three attributes only.
        other: Any = SimpleNamespace(name=study.name, **named)
        cases = sum(
            block.cases
            for block in missing.values()
            if store.path(block_key(other, block)).name in present
        )
        if cases:
            change = [
                f"{kind.replace('_', ' ')} {old} -> {getattr(study, kind)}"
                for kind, old in named.items()
                if old != getattr(study, kind)
            ]
            changes[", ".join(change)] = cases
    return changes


def _read_versions(path: Path, default: tuple[int, int]) -> tuple[int, int]:
    """Read the schema version and the numerics version from the metadata of a shard.

    A shard is a stored file of rows. Return `default` if the file cannot be read or lacks one of
    the two versions.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        require_regular(path, links=False)  # a pipe would block
        entries = pq.read_metadata(path).metadata or {}
        schema, numerics = (int(entries[f"{PREFIX}{kind}".encode()]) for kind in KINDS)
    except (pa.ArrowException, OSError, KeyError, ValueError):
        return default
    return schema, numerics
