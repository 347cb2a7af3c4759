"""Versions, which decide whether stored blocks equal what this program would compute now."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from itertools import islice
from typing import Any, cast

from owtsweep.sweep.keys import block_key
from owtsweep.sweep.plan import Plan
from owtsweep.sweep.shard import PREFIX
from owtsweep.sweep.store import Store
from owtsweep.sweep.study import Study

#: The number of shards outside the plan whose versions are read: enough to find all versions.
SAMPLE = 64
KINDS = ("schema_version", "numerics_version")


def shard_metadata(study: Study) -> dict[str, str | int]:
    """The metadata of every shard of a study, besides its key."""
    return {
        "study": study.name,
        "schema_version": study.schema_version,
        "numerics_version": study.numerics_version,
    }


def all_versions(study: Study) -> dict[str, str]:
    """The metadata of a study's shards, and the version of this package, as text."""
    from owtsweep import __version__

    entries = {**shard_metadata(study), "owtsweep_version": __version__}
    return {name: str(value) for name, value in entries.items()}


@cache
def package_version(name: str) -> str | None:
    """The installed version of a package; None if it is not installed."""
    try:
        return version(name)
    except PackageNotFoundError:
        return None


def tell_other_versions(study: Study, expected: Mapping[str, str]) -> str:
    """Why a worker whose versions are not the expected ones is refused; empty if they agree."""
    ours = all_versions(study)
    differing = [name for name, value in expected.items() if ours.get(name, value) != value]
    if not differing:
        return ""
    told = ", ".join(f"{name} {ours[name]} instead of {expected[name]}" for name in differing)
    return f"the worker has {told}; give it the coordinator's version of owtsweep"


@dataclass(frozen=True)
class _OtherVersion:
    """A study reduced to the three values that a block's key depends on."""

    name: str
    schema_version: int
    numerics_version: int


def count_outdated(study: Study, store: Store, plan: Plan, missing: Plan) -> dict[str, int]:
    """How many of the missing cases are stored in another version: `change -> cases`.

    Versions are part of a block's key, so shards of other versions have names outside the plan. A
    sample of them shows which versions exist; then the names that the missing blocks would have
    in those versions are looked up.
    """
    if not missing:
        return {}
    present = {path.name for path in store.cases.glob("part-*.parquet")}
    foreign = sorted(present - {store.path(key).name for key in plan})
    changes: dict[str, int] = {}
    for schema, numerics in sorted(_versions(store, foreign)):
        if (schema, numerics) == (study.schema_version, study.numerics_version):
            continue
        other = cast(Study, _OtherVersion(study.name, schema, numerics))
        cases = sum(
            block.cases
            for block in missing.values()
            if store.path(block_key(other, block)).name in present
        )
        if cases:
            changes[_change(study, schema, numerics)] = cases
    return changes


def _versions(store: Store, names: list[str]) -> set[tuple[int, int]]:
    # Keys are hashes, so evenly spaced names are a random sample.
    step = max(1, len(names) // SAMPLE)
    pairs = (_stored_versions(store.cases / name) for name in islice(names, 0, None, step))
    return {pair for pair in pairs if pair is not None}


def _stored_versions(path: Any) -> tuple[int, int] | None:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        entries = pq.read_metadata(path).metadata or {}
        schema, numerics = (int(entries[f"{PREFIX}{kind}".encode()]) for kind in KINDS)
    except (pa.ArrowException, OSError, KeyError, ValueError):
        return None
    return schema, numerics


def _change(study: Study, schema: int, numerics: int) -> str:
    olds: Iterable[int] = (schema, numerics)
    news = (study.schema_version, study.numerics_version)
    return ", ".join(
        f"{kind.replace('_', ' ')} {old} -> {new}"
        for kind, old, new in zip(KINDS, olds, news, strict=True)
        if old != new
    )
