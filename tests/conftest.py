"""Fixtures for all tests."""

from __future__ import annotations

import io
import pickle
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import pytest


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
def _equal_words_are_composed_once() -> Iterator[None]:
    """Compose each list of overrides once per process: a composition takes a tenth of a second.

    The user's own files are composed each time: of a folder that Hydra searches the content may
    change, and an option that is a file has a new name each time.
    """
    from owtsweep.config import composition

    composed: dict[tuple[object, ...], bytes] = {}
    compose = composition._compose

    def remembering(tree: Any, words: Sequence[str]) -> Any:
        if any(word.startswith("hydra.") for word in words):
            return compose(tree, words)
        key = (tree.folder, tree.primary, *words)
        if key not in composed:
            composed[key] = pickle.dumps(compose(tree, words))
        return pickle.loads(composed[key])

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(composition, "_compose", remembering)
        yield


@pytest.fixture(scope="session")
def kernels() -> None:
    """Compile the hub study's kernels (or load them from numba's cache) once per session."""
    from owtsweep.studies import compose
    from owtsweep.studies.base.blocks import DeclaredBlocks
    from owtsweep.studies.hub.declaration import find_declaration

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
