"""What the hub offers to other studies, and that they take nothing else of it."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from owtsweep.studies.hub import public

SOURCE = Path(public.__file__).parents[2]


def test_every_name_is_there():
    later = {name for names in public._HOMES.values() for name in names}
    assert not later & {*vars(public)}
    assert later | {n for n in vars(public) if n in public.__all__} == {*public.__all__}
    for name in public.__all__:
        assert getattr(public, name) is not None
    with pytest.raises(AttributeError, match="no attribute 'expand_lanes'"):
        public.expand_lanes  # noqa: B018


@pytest.mark.parametrize("room", ["evaluation", "studies/replay"])
def test_other_rooms_import_nothing_else(room):
    imported = {
        module
        for file in (SOURCE / room).rglob("*.py")
        for module in re.findall(
            r"(?:from|import) (owtsweep\.studies\.hub[\w.]*)",
            file.read_text().replace("studies.hub import public as hub", "studies.hub.public"),
        )
    }
    assert imported == (set() if room == "evaluation" else {"owtsweep.studies.hub.public"})


def test_every_name_is_used():
    texts = [
        file.read_text()
        for room in ("studies/replay", "testing")
        for file in (SOURCE / room).rglob("*.py")
    ]
    unused = [n for n in public.__all__ if not any(re.search(rf"\b{n}\b", t) for t in texts)]
    assert unused == []


def test_light_names_load_nothing_heavy():
    code = (
        "import sys; from owtsweep.studies.hub.public import Sensors, Scheme; import "
        "owtsweep.studies.replay; print(*sys.modules)"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    loaded = {name.partition(".")[0] for name in done.stdout.split()}
    assert loaded & {"matplotlib", "numba", "pandas", "pyarrow", "scipy", "optuna"} == set()
