"""Fixtures for all tests."""

from __future__ import annotations

import gc
import io
import pickle
from collections.abc import Iterator, Sequence
from functools import wraps
from pathlib import Path
from typing import Any

import pytest
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.override_parser.types import Override
from omegaconf import OmegaConf


def pytest_collection_finish() -> None:
    """Let the garbage collector look seldom, and not at what is imported: that took a tenth."""
    gc.collect()
    gc.freeze()
    gc.set_threshold(100_000, 50, 50)


@pytest.fixture(scope="session", autouse=True)
def _yaml_is_parsed_once() -> Iterator[None]:
    """Parse each text once per process: composing reads the same thirty files every time.

    The texts are still read. What cannot be parsed is not kept, so that errors are OmegaConf's.
    """
    from omegaconf import OmegaConf

    parsed: dict[str, bytes] = {}
    load = OmegaConf.load

    def remembering(file: Any) -> Any:
        if isinstance(file, (str, Path)):
            with open(file, encoding="utf-8") as opened:
                return remembering(opened)
        if not isinstance(file, io.TextIOBase):
            return load(file)
        start = file.tell()
        text = file.read()
        if text not in parsed:
            file.seek(start)
            parsed[text] = pickle.dumps(load(file))
        return pickle.loads(parsed[text])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(OmegaConf, "load", staticmethod(remembering))
        yield


@pytest.fixture(scope="session", autouse=True)
def _files_are_joined_once() -> Iterator[None]:
    """Let Hydra join each choice of files once per process, and set values of keys as it does.

    Composing takes a tenth of a second, nearly all of it for joining files. Words that do more than
    set values, or are refused, are left to Hydra as a whole. tests/config/test_composing.py looks
    whether the result is Hydra's own.
    """
    from owtsweep.config import composition

    joined: dict[tuple[object, ...], bytes] = {}
    compose = composition.compose_hydra

    @wraps(compose)
    def remembering(tree: Any, words: Sequence[str], *, settings: bool = False) -> Any:
        groups = tree.groups()
        values = [word for word in words if composition.get_key(word) not in groups]
        choices = [word for word in words if word not in values]
        overrides = _parse_values(values)
        if overrides is None or any("={" in word for word in choices):
            return compose(tree, words, settings=settings)
        key = (tree.folder, tree.primary, settings, *choices)
        if key not in joined:
            joined[key] = pickle.dumps(compose(tree, choices, settings=settings))
        config = pickle.loads(joined[key])
        try:
            for override in overrides:
                OmegaConf.update(
                    config,
                    override.key_or_group,
                    override.value(),
                    force_add=override.is_force_add(),
                )
        except Exception:
            return compose(tree, words, settings=settings)
        return config

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(composition, "compose_hydra", remembering)
        yield


def _parse_values(words: Sequence[str]) -> list[Override] | None:
    """Return what words set, read by Hydra's parser; None if one of them does something else."""
    if any(word.startswith(("hydra", "+hydra", "~")) for word in words):
        return None
    try:
        overrides = OverridesParser.create().parse_overrides(overrides=list(words))
    except Exception:
        return None
    plain = all(
        not (each.is_add() or each.is_delete() or each.is_sweep_override()) and each.package is None
        for each in overrides
    )
    return overrides if plain else None


@pytest.fixture(scope="session")
def kernels() -> None:
    """Compile the hub study's kernels (or load them from numba's cache) once per session."""
    from owtsweep.studies import compose
    from owtsweep.studies.base.blocks import DeclaredBlocks
    from owtsweep.studies.hub.engines import find_declaration

    small = [
        "grid.natural_period=[4.0]", "grid.amplitude=[1.0]", "grid.replicates=1",
        "record.duration=10", "measures.settling_time=1", "sensors.imu.rate=20",
        "schemes=[HME1]", "tuning=matched",
    ]  # fmt: skip
    for evaluation in ("superposed", "direct"):
        config = compose([*small, f"evaluation={evaluation}"])
        blocks = DeclaredBlocks(find_declaration(config))  # type: ignore[arg-type]
        for _ in blocks.run(config, blocks.plan(config)):
            pass
